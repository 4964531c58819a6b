// SPDX-License-Identifier: Apache-2.0
// How training moves the coefficients of contact: each is a logistic function (logistic.h) of a
// number that may be any, to which something is added.
//   y = top / (1 + exp(-(logit y_0 + added)))
#ifndef PHYSPRING_TRAINER_BODIES_CONTACT_LOGITS_H_
#define PHYSPRING_TRAINER_BODIES_CONTACT_LOGITS_H_

#include "trainer/bodies/logistic.h"
#include "twin/contact_law.h"

namespace physpring {

// One number a coefficient, in the order of kContactCoefficients.
using ContactLogits = Eigen::Matrix<double, kContactCount, 1>;

inline void MoveLogits(const ContactLogits& added, ContactPair<double>* pair) {
  for (int i = 0; i < kContactCount; ++i) {
    const auto& c = kContactCoefficients<double>[i];
    pair->*c.member = Sigmoid(Logit(pair->*c.member, c.most) + added[i], c.most);
  }
}

// d loss / d added, from the derivatives with respect to the coefficients as they were moved.
inline ContactLogits MoveLogitsAdjoint(const ContactPair<double>& moved,
                                       const ContactPair<double>& moved_bar) {
  ContactLogits added_bar;
  for (int i = 0; i < kContactCount; ++i) {
    // dy/dx = y (1 - y / top)
    const auto& c = kContactCoefficients<double>[i];
    const double y = moved.*c.member;
    added_bar[i] = moved_bar.*c.member * y * (1 - y / c.most);
  }
  return added_bar;
}

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_BODIES_CONTACT_LOGITS_H_
