// SPDX-License-Identifier: Apache-2.0
// The numbers in the film of a page (report/picture/film_data.h).
#ifndef PHYSPRING_TESTS_SUPPORT_FILM_TRIPLE_H_
#define PHYSPRING_TESTS_SUPPORT_FILM_TRIPLE_H_

#include <Eigen/Core>
#include <cmath>
#include <string>

namespace physpring {

// Three numbers from the 16-bit data of the film, in steps.
inline Eigen::Vector3d DecodeTriple(const std::string& base64, std::size_t triple) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto bits = [&](std::size_t bit) {
    const auto digit = digits.find(base64.at(bit / 6));
    return digit >> (5 - bit % 6) & 1;
  };
  Eigen::Vector3d values = Eigen::Vector3d::Zero();
  for (int j = 0; j < 3; ++j) {
    for (int byte = 0; byte < 2; ++byte) {  // little endian
      for (int k = 0; k < 8; ++k) {
        const std::size_t bit = (triple * 6 + 2 * j + byte) * 8 + k;
        values[j] += std::ldexp(bits(bit), 8 * byte + 7 - k);
      }
    }
  }
  return values;
}

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_FILM_TRIPLE_H_
