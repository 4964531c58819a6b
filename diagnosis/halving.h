// SPDX-License-Identifier: Apache-2.0
// Successive halving: all fits make a few steps, the better part goes on.
#ifndef PHYSPRING_DIAGNOSIS_HALVING_H_
#define PHYSPRING_DIAGNOSIS_HALVING_H_

#include <span>
#include <string>
#include <vector>

#include "diagnosis/fitting.h"

namespace physpring {

// How many steps all fits make, and how many fits go on after that: in all, and with one effect.
struct Cut {
  double gain;
  int steps;
  std::size_t kept, of_an_effect;
  Fitting::Care care = Fitting::Care::kRough;
};

// Keeps the best fits by misfit, best first, and, beside others, the best one of each free form.
// Under the highest gain a fit of few steps may be far off yet, so none is hopeless.
void Keep(const Cut& cut, std::vector<Descent>* fits);

// Makes all cuts. The best fit by misfit is the first one after it. `stage`: the share of the work;
// `of`: what the fits are, for the journal.
void Halve(const Fitting& fitting, std::span<const Cut> cuts, const WorkShare& stage,
           const std::string& of, std::vector<Descent>* fits);

// The verdicts on the fits, the least held-out error first.
std::vector<Verdict> JudgeAndSort(const Fitting& fitting, const std::vector<Descent>& fits);

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_HALVING_H_
