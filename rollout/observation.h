// SPDX-License-Identifier: Apache-2.0
// What a camera would make of exact points: noise, and parts that are hidden for a while.
#ifndef PHYSPRING_ROLLOUT_OBSERVATION_H_
#define PHYSPRING_ROLLOUT_OBSERVATION_H_

#include <cstdint>
#include <vector>

#include "twin/points.h"

namespace physpring {

// Adds to each coordinate of each frame but the first an independent normal error of standard
// deviation `noise` [m].
void AddNoise(double noise, std::uint64_t seed, std::vector<Points>* frames);

// Hides, as NaN, the fraction `hidden` (in [0, 1), rounded to whole points) of the points in each
// frame but the first: those nearest to two spots, each of which wanders from point to point of the
// object, one a second.
void AddOcclusion(double hidden, double fps, std::uint64_t seed, std::vector<Points>* frames);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_OBSERVATION_H_
