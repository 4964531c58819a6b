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
  std::string refusal;  // why the best effect of the last round is not added; empty: there was none
};

// `known`: effects that the twin has besides the body's own. `trained`: the twin as it came, taken
// where it predicts the held-out frames better than a refit. `share` is the share of all work.
// Returns nothing if the model without new effects diverges.
std::optional<Findings> FindEffects(const Fitting& fitting, double noise_floor,
                                    const DiagnosisOptions& options, const WorkShare& share,
                                    const std::vector<EffectValues>& known,
                                    const std::optional<Verdict>& trained);

// How much smaller the errors of held-out frames are with the effects, by a paired block bootstrap.
BootstrapResult GainOf(const Fitting& fitting, std::uint64_t seed, const FrameTrack& without,
                       const FrameTrack& with);

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_FIND_EFFECTS_H_
