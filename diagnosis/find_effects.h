// SPDX-License-Identifier: Apache-2.0
// Adding effects to a twin's model, one after the other: search, choice, test and training, as
// diagnosis.h lists them.
#ifndef PHYSPRING_DIAGNOSIS_FIND_EFFECTS_H_
#define PHYSPRING_DIAGNOSIS_FIND_EFFECTS_H_

#include <optional>
#include <string>
#include <vector>

#include "diagnosis/diagnosis.h"
#include "diagnosis/fitting.h"

namespace physpring {

struct Findings {
  Verdict before, accepted;             // without any new effect, and with those that were accepted
  std::vector<EffectRanking> rankings;  // one for each round
  BootstrapResult gain;                 // of all that were accepted
  std::string refusal;  // why the best effect of the last round is not added; empty: there was none
  int law_terms = 0;    // so many of the last effects that were accepted are terms of a law
};

// `known`: effects that the twin has besides the body's own. `trained`: the twin as it came, taken
// where it predicts the held-out frames better than a refit. `share` is the share of all work.
// Returns nothing if the model without new effects diverges.
std::optional<Findings> FindEffects(const Fitting& fitting, double noise_floor,
                                    const DiagnosisOptions& options, const WorkShare& share,
                                    const std::vector<EffectValues>& known,
                                    const std::optional<Verdict>& trained);

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_FIND_EFFECTS_H_
