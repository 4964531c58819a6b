// SPDX-License-Identifier: Apache-2.0
// Splats of every size, turn and colour, for tests.
#ifndef PHYSPRING_TESTS_SPLATS_RANDOM_SPLATS_H_
#define PHYSPRING_TESTS_SPLATS_RANDOM_SPLATS_H_

#include <random>

#include "splats/splats.h"
#include "twin/uniform.h"

namespace physpring {

// In a cube of 1.2 m about the origin.
inline Splats RandomSplats(int count, int degree, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto between = [&](double from, double to) {
    return static_cast<float>(from + (to - from) * Uniform(&random));
  };
  Splats splats;
  splats.Resize(count, degree);
  for (float& x : splats.position.reshaped()) x = between(-0.6, 0.6);
  for (float& x : splats.log_scale.reshaped()) x = between(-5, -2.5);
  for (float& x : splats.rotation.reshaped()) x = between(-1, 1);
  for (float& x : splats.logit) x = between(-4, 5);
  for (float& x : splats.harmonics.reshaped()) x = between(-0.6, 0.6);
  return splats;
}

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SPLATS_RANDOM_SPLATS_H_
