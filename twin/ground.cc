// SPDX-License-Identifier: Apache-2.0
#include "twin/ground.h"

#include <fmt/format.h>

#include <cmath>

namespace physpring {
namespace {

constexpr double kSameNormal = 1e-3, kSameDistance = 1e-3;  // rad, m

}  // namespace

std::string DescribeGround(const std::optional<Eigen::Vector4d>& ground) {
  if (!ground) return "none";
  const Eigen::Vector4d& plane = *ground;
  return fmt::format("{:g} x + {:g} y + {:g} z = {:g} m", plane[0], plane[1], plane[2], plane[3]);
}

bool SameGround(const std::optional<Eigen::Vector4d>& p, const std::optional<Eigen::Vector4d>& q) {
  if (!p || !q) return !p && !q;
  return (p->head<3>() - q->head<3>()).norm() <= kSameNormal &&
         std::abs((*p)[3] - (*q)[3]) <= kSameDistance;
}

}  // namespace physpring
