// SPDX-License-Identifier: Apache-2.0
// A spring net as a material: few numbers say how stiff and how lossy its springs are, and none is
// of a single spring. They are those of parameters.h:
//   global      stiffness, loss time (dashpot / stiffness), drag, contact, effects
//   classes     the stiffness of springs of one length
//   one field       8 modes of stiffness along the body (spring_modes.h)
// Single springs bend to one motion, and then predict no other one. These numbers do not: of bodies
// that are networks they find the true ones (docs/decisions/111-smooth-bodies.md).
#ifndef PHYSPRING_TRAINER_BODIES_SMOOTH_BODY_H_
#define PHYSPRING_TRAINER_BODIES_SMOOTH_BODY_H_

#include "trainer/bodies/body.h"
#include "trainer/bodies/parameters.h"

namespace physpring {

class SmoothBody {
 public:
  // `start`: the system at x = 0, whose springs have one loss time. `most_rate`: the most sub-steps
  // a second that a system may need.
  SmoothBody(const SpringMassSystem& start, const Recording& recording, const BodyKind& kind,
             double most_rate);

  int size() const { return factors_.size(); }
  double most_rate() const { return most_rate_; }
  Eigen::VectorXd Precision() const;  // the prior's, of each entry

  // Where stiffness leaves too little room for them, the dashpots are lowered by one factor: a fit
  // that could not go there would be stuck at the most sub-steps.
  SpringMassSystem Apply(const Eigen::VectorXd& x) const;

 private:
  Parameters factors_;
  double most_rate_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_BODIES_SMOOTH_BODY_H_
