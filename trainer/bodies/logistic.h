// SPDX-License-Identifier: Apache-2.0
// A coefficient between 0 and `top` as a logistic function of any number.
#ifndef PHYSPRING_TRAINER_BODIES_LOGISTIC_H_
#define PHYSPRING_TRAINER_BODIES_LOGISTIC_H_

#include <algorithm>
#include <cmath>

namespace physpring {

inline double Sigmoid(double x, double top) { return top / (1 + std::exp(-x)); }

// The inverse of Sigmoid. The value is kept off the ends 0 and `top`.
inline double Logit(double value, double top) {
  const double p = std::clamp(value / top, 1e-3, 1 - 1e-3);
  return std::log(p / (1 - p));
}

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_BODIES_LOGISTIC_H_
