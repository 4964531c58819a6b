// SPDX-License-Identifier: Apache-2.0
#include "rollout/scene_ground.h"

#include <fmt/format.h>

#include <algorithm>

#include "twin/ground.h"

namespace physpring {

std::vector<Eigen::Vector4d> GroundsOf(const mjModel& model, const mjData& data) {
  std::vector<Eigen::Vector4d> grounds;
  for (int geom = 0; geom < model.ngeom; ++geom) {
    const bool fixed = model.body_weldid[model.geom_bodyid[geom]] == 0;
    const bool collides = model.geom_contype[geom] != 0 || model.geom_conaffinity[geom] != 0;
    if (model.geom_type[geom] != mjGEOM_PLANE || !fixed || !collides) continue;
    const mjtNum* frame = data.geom_xmat + 9 * geom;  // rows; its normal is the third column
    const Eigen::Vector3d normal(frame[2], frame[5], frame[8]);
    Eigen::Vector4d plane;
    plane << normal, normal.dot(Eigen::Map<const Eigen::Vector3d>(data.geom_xpos + 3 * geom));
    grounds.push_back(plane);
  }
  return grounds;
}

std::string OtherGround(const mjModel& model, const mjData& data, const Recording& recording) {
  const std::vector<Eigen::Vector4d> grounds = GroundsOf(model, data);
  const auto is_recorded = [&](const Eigen::Vector4d& ground) {
    return SameGround(ground, recording.ground);
  };
  const auto other = std::find_if_not(grounds.begin(), grounds.end(), is_recorded);
  if (other == grounds.end() && (!recording.ground || !grounds.empty())) return "";
  return fmt::format(
      "its ground is {}, that of recording {} is {}: they need not move alike",
      DescribeGround(other == grounds.end() ? std::optional<Eigen::Vector4d>() : *other),
      recording.name, DescribeGround(recording.ground));
}

}  // namespace physpring
