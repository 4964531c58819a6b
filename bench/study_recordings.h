// SPDX-License-Identifier: Apache-2.0
// Small bodies of tendons in MuJoCo with an effect that nobody declares (undeclared_effects.h):
// what a diagnosis is tried on.
#ifndef PHYSPRING_BENCH_STUDY_RECORDINGS_H_
#define PHYSPRING_BENCH_STUDY_RECORDINGS_H_

#include <cstdint>
#include <string>
#include <vector>

#include "twin/recording.h"

namespace physpring {

enum class StudyBody { kRope, kSheet, kBlock };

// The names of the effects that a study tries: those of rollout/effects that have a trial. A
// diagnosis knows all but those that only scenes have (twin/effects/list.h).
const std::vector<std::string>& StudyEffects();

struct MadeRecordings {
  Recording fit, other;     // two motions of one body
  double displacement = 0;  // mean distance that the effect makes on the first one, m
  Points outside;  // 3 x steps of a frame of the first: net force of the effect from outside, N
};

// `noise`: standard deviation of a coordinate, m. The seed draws the motions, the effect's size and
// place, and the noise. Throws Error if MuJoCo warns.
MadeRecordings MakeWithEffect(StudyBody body, const std::string& effect, double noise,
                              std::uint64_t seed);

}  // namespace physpring

#endif  // PHYSPRING_BENCH_STUDY_RECORDINGS_H_
