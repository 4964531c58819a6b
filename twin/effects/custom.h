// SPDX-License-Identifier: Apache-2.0
// The effect `custom`: one term of a law that no other effect is, found from the data
// (diagnosis/law_search.h). A term acts on something, times a course c(t) in time. A system may
// have several of them. Forces are in N, m is a node's mass:
//   on the node       force m c
//   its place         force m c * (x - x0), entry by entry; x0: the body's mean at rest
//   its velocity      force m c * v
//   the stretch       extra tension c_x k (l - L)
//   its square        extra tension c_x k (l - L)^2 / L
// The course is constant (a), growing (a t), its square (a t^2), or periodic
// (a sin(w t) + b cos(w t)).
// A term of the stretch never takes a spring more than nine tenths of its stiffness, and never
// gives it more than four times that.
#ifndef PHYSPRING_TWIN_EFFECTS_CUSTOM_H_
#define PHYSPRING_TWIN_EFFECTS_CUSTOM_H_

namespace physpring {

enum class ActsOn { kNode, kPlace, kVelocity, kStretch, kSquare };
enum class InTime { kConstant, kGrowing, kSquare, kPeriodic };

// The values: acts on, in time, w [rad/s], a (3), b (3).
inline constexpr char kCustom[] = "custom";
inline constexpr int kCustomActsOn = 0, kCustomInTime = 1, kCustomRate = 2, kCustomA = 3,
                     kCustomB = 6, kCustomValues = 9;

}  // namespace physpring

#endif  // PHYSPRING_TWIN_EFFECTS_CUSTOM_H_
