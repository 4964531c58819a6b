// SPDX-License-Identifier: Apache-2.0
// Random numbers that are the same with every standard library: the generators of <random> are
// fixed by the C++ standard, its distributions are not.
#ifndef PHYSPRING_TWIN_UNIFORM_H_
#define PHYSPRING_TWIN_UNIFORM_H_

#include <cmath>
#include <numbers>
#include <random>

namespace physpring {

// The next number in [0, 1), evenly distributed: the upper 53 bits of the generator's next 64.
inline double Uniform(std::mt19937_64* random) {
  return static_cast<double>((*random)() >> 11) * 0x1p-53;
}

// The next number of a standard normal distribution, by Box and Muller's method.
inline double Normal(std::mt19937_64* random) {
  const double radius = std::sqrt(-2 * std::log(1 - Uniform(random)));
  return radius * std::cos(2 * std::numbers::pi * Uniform(random));
}

}  // namespace physpring

#endif  // PHYSPRING_TWIN_UNIFORM_H_
