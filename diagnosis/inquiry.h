// SPDX-License-Identifier: Apache-2.0
// What all rounds of a diagnosis have in common: the fits, the noise, and what an effect must gain.
#ifndef PHYSPRING_DIAGNOSIS_INQUIRY_H_
#define PHYSPRING_DIAGNOSIS_INQUIRY_H_

#include <vector>

#include "diagnosis/acceptance.h"
#include "diagnosis/diagnosis.h"
#include "diagnosis/fitting.h"

namespace physpring {

struct Inquiry {
  const Fitting& fitting;
  double noise_floor;
  const DiagnosisOptions& options;
  std::vector<const Effect*> effects;  // those that may be missing

  // How many frames the bootstrap draws together.
  int Block() const;
  // How much smaller the errors of held-out frames are with the effects.
  BootstrapResult Gain(const FrameTrack& without, const FrameTrack& with) const;
  BootstrapResult Gain(const Verdict& without, const Verdict& with) const {
    return Gain(without.held, with.held);
  }
  // The threshold for the one that is chosen among so many refits.
  Threshold ThresholdFor(std::size_t tried) const;
};

// The effects that a diagnosis of the bodies looks for: those that a body like the first one may
// lack and has not, and that held-out frames can judge.
Inquiry InquiryOf(const Fitting& fitting, double noise_floor, const DiagnosisOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_INQUIRY_H_
