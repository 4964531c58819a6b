// SPDX-License-Identifier: Apache-2.0
// The rules of a diagnosis, as functions of numbers: which fits go on, which one is chosen, and
// when its effect is accepted. Errors are mean track errors of held-out frames, m; a gain is the
// paired block bootstrap of the errors without minus those with.
#ifndef PHYSPRING_DIAGNOSIS_ACCEPTANCE_H_
#define PHYSPRING_DIAGNOSIS_ACCEPTANCE_H_

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "diagnosis/block_bootstrap.h"

namespace physpring {

// Errors below this, times the noise floor, are no more than noise: nothing is missing. A body that
// lacks little comes near to that, too.
inline constexpr double kExplained = 1.05;

bool IsExplained(double error, double noise_floor);

// Whether an error leaves so much that it is told where it comes from.
bool IsUnexplained(double error, double noise_floor);

// Whether an error is so near to noise that a more careful fit of the body may get there.
bool IsNearNoise(double error, double noise_floor);

// Whether there is nothing to look for, by the error with those effects that were accepted.
bool NothingIsLeft(int accepted, double error, double noise_floor);

// Whether an effect of so many parameters takes the shape of others. It does not compete with them.
bool IsFreeForm(Eigen::Index parameters);

// Whether held-out frames can judge an effect: between frames that are fitted nearly any free form
// is right.
bool CanBeJudged(Eigen::Index parameters, bool judged_in_between);

// Whether a gain is more than its standard error: many parameters must be better than few by that
// much.
bool IsSurelyBetter(const BootstrapResult& gain);
// Whether a fit is as good as the best one. `worse` is made of its errors minus those of the best.
bool IsAlike(const BootstrapResult& worse);

// Whether a fit with another law of the springs leaves so much less of the squared misfit than the
// body alone that all bodies are tried with it.
bool IsStrongLaw(double misfit, double misfit_alone);
// Whether a fit under an observer is too bad to go on beside the one with the least misfit.
bool IsHopeless(double misfit, double least_misfit);
// Whether a trace's score is worth a refit, beside the best one.
bool IsWorthRefit(double score, double best_score);

// What an effect must explain, by squares of errors: those of noise and of what is missing add up.
struct Threshold {
  double noise_floor;  // m
  double false_alarm;  // rate at which a model that lacks nothing gets an effect
  double least_gain;   // of the square above that of the noise floor, the part that it must take
  double least_noise;  // the root of the square that it takes, as a part of the noise floor
  int tried;           // how many refits it was chosen among
};

// Whether the gain over a fit with the error `without` is no chance, and large enough.
bool IsWorthIt(const BootstrapResult& gain, double without, const Threshold& threshold);
// The first of these conditions that does not hold, with its numbers, in words; empty if all hold.
std::string WhyNotWorthIt(const BootstrapResult& gain, double without, const Threshold& threshold);

// Whether another effect came so near to the chosen one that the next search is made beside each.
bool IsNear(double error, double chosen_error);

// A fit of so many parameters with its errors on held-out frames, one after the other, and their
// mean.
struct Scored {
  Eigen::Index parameters;
  double mean;
  std::vector<double> held;
};

// Which of `fits` to take: the one with the fewest parameters among those that are no worse than
// noise, or as good as the one with the least error, by chance or by as much as fits can tell.
// `block`: frames that are drawn together. `fits` is not empty.
std::size_t ChooseSimplest(const std::vector<Scored>& fits, double noise_floor, int block,
                           std::uint64_t seed);

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_ACCEPTANCE_H_
