// SPDX-License-Identifier: Apache-2.0
// The ground of a recording, of a twin or of a scene: a plane (a, b, c, d) with a x + b y + c z = d
// and |(a, b, c)| = 1, or none.
#ifndef PHYSPRING_TWIN_GROUND_H_
#define PHYSPRING_TWIN_GROUND_H_

#include <Eigen/Core>
#include <optional>
#include <string>

namespace physpring {

// "0 x + 0 y + 1 z = 0.2 m", or "none".
std::string DescribeGround(const std::optional<Eigen::Vector4d>& ground);

// Whether a body meets both at the same place: normals within 1 mrad, distances within 1 mm; or
// whether there is none in both.
bool SameGround(const std::optional<Eigen::Vector4d>& p, const std::optional<Eigen::Vector4d>& q);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_GROUND_H_
