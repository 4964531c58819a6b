// SPDX-License-Identifier: Apache-2.0
// A spring net that hangs at rest in frame 0: its springs are stretched there, so that they carry
// its weight, and frame 0 is not its stress-free shape. How the strain is spread over the springs
// is a matter of statics, how large it is of the fit:
//   L = l R(a s),   R(x) = 1 / (1 + x)
// with L the rest length, l the length in frame 0, s the spring's share (the largest is 1) and a
// the largest strain. Springs of the same material along a rope get the same L / l of its unloaded
// shape. Below x = -1/2, a compression that no real net begins with, R goes on as a straight line.
#ifndef PHYSPRING_TRAINER_BODIES_HANGING_NET_H_
#define PHYSPRING_TRAINER_BODIES_HANGING_NET_H_

#include <array>

#include "trainer/bodies/body.h"

namespace physpring {

// Whether a recording starts with the object hanging at rest from its controllers: within 0.04 s it
// does not fall as a net does whose springs are slack, nor does it move or lie on a ground.
bool HangsAtRest(const Recording& recording);

// `body`, whose springs carry its weight in frame 0 of `recording`.
Body HangingNet(const Recording& recording, Body body);

// Shares of the strain (springs), the largest size being 1, with which the springs of `system`
// carry the weight of its nodes where they are: those of least energy, as far as they can. All 0
// where they carry nothing.
Eigen::VectorXd StrainShares(const SpringMassSystem& system, const Eigen::Vector3d& gravity);

// The largest strains that a search of start values tries.
inline constexpr std::array<double, 6> kStretches = {0.03, 0.07, 0.15, 0.3, 0.6, 1.2};

// R(x), its derivative, and the x with R(x) = r > 0.
double RestRatio(double x);
double RestRatioSlope(double x);
double StrainOfRatio(double r);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_BODIES_HANGING_NET_H_
