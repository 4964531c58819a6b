// SPDX-License-Identifier: Apache-2.0
// The cones of friction as words, in files, options and MJCF: those of MuJoCo's <option cone>.
#ifndef PHYSPRING_TWIN_CONE_NAME_H_
#define PHYSPRING_TWIN_CONE_NAME_H_

#include <string_view>

#include "twin/friction_cone.h"

namespace physpring {

inline constexpr const char* kElliptic = "elliptic";
inline constexpr const char* kPyramidal = "pyramidal";

inline const char* ConeName(FrictionCone cone) {
  return cone == FrictionCone::kElliptic ? kElliptic : kPyramidal;
}

// `name` is one of the two.
inline FrictionCone ConeOf(std::string_view name) {
  return name == kPyramidal ? FrictionCone::kPyramidal : FrictionCone::kElliptic;
}

}  // namespace physpring

#endif  // PHYSPRING_TWIN_CONE_NAME_H_
