// SPDX-License-Identifier: Apache-2.0
// Random spring-mass systems, the same on every machine for the same seed.
#ifndef PHYSPRING_TESTS_SUPPORT_RANDOM_SYSTEM_H_
#define PHYSPRING_TESTS_SUPPORT_RANDOM_SYSTEM_H_

#include <cstdint>
#include <random>

#include "twin/points.h"
#include "twin/spring_mass_system.h"
#include "twin/uniform.h"

namespace physpring {

class Random {
 public:
  explicit Random(std::uint64_t seed) : generator_(seed) {}
  // Uniform in [low, high).
  double operator()(double low, double high) { return low + (high - low) * Uniform(&generator_); }
  double Normal() { return physpring::Normal(&generator_); }  // of deviation 1
  // 3 x count, each entry uniform in [-size, size).
  Points Box(int count, double size) {
    Points points(3, count);
    for (double& value : points.reshaped()) value = (*this)(-size, size);
    return points;
  }

 private:
  std::mt19937_64 generator_;
};

// A cloud of `nodes` free nodes and `controllers` in a box of 0.2 m, each free node joined to its
// nearest ones (about 4 springs a node), with random masses (10 to 30 g), stiffnesses (20 to 60
// N/m), dashpots (0.02 to 0.1 N s/m) and rest lengths (0.8 to 1.2 of the distance). Contact radius
// 5 mm, no collisions between particles.
SpringMassSystem RandomSystem(int nodes, int controllers, std::uint64_t seed);

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_RANDOM_SYSTEM_H_
