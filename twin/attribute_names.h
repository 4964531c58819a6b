// SPDX-License-Identifier: Apache-2.0
// The names of the plugin's attributes that are no numbers of a level (those: level_numbers.h). The
// exporter writes them, the plugin reads them.
#ifndef PHYSPRING_TWIN_ATTRIBUTE_NAMES_H_
#define PHYSPRING_TWIN_ATTRIBUTE_NAMES_H_

namespace physpring {

inline constexpr const char* kAttrNodes = "nodes";
inline constexpr const char* kAttrControllers = "controllers";
inline constexpr const char* kAttrSprings = "springs";
inline constexpr const char* kAttrOrder = "order";
inline constexpr const char* kAttrRod = "rod";
inline constexpr const char* kAttrEffects = "effects";
inline constexpr const char* kAttrSubstep = "substep";
inline constexpr const char* kAttrDashpotStages = "dashpot_stages";
inline constexpr const char* kAttrControllerVelocity = "controller_velocity";
inline constexpr const char* kAttrReleased = "released";
inline constexpr const char* kAttrCone = "cone";

}  // namespace physpring

#endif  // PHYSPRING_TWIN_ATTRIBUTE_NAMES_H_
