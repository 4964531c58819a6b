// SPDX-License-Identifier: Apache-2.0
#include "rollout/policies/cloth_folding.h"

#include <cmath>

#include "rollout/policies/hand_down.h"
#include "rollout/task_fields.h"

namespace physpring {
namespace {

// The pads come down to both sides of the diagonal, so far from the corner, and close: the cloth
// between them buckles up. What they hold then hangs down by less than that.
constexpr double kPinch = 0.05;    // m
constexpr double kTable = 0.022;   // m, of the hand: the pads press on the table
constexpr double kCarry = 0.09;    // m, of the hand above the table
constexpr double kLay = 0.035;     // m, of the hand where it opens
constexpr double kForward = 0.14;  // m: the corner falls so far in front of where it was let go

}  // namespace

ClothFolding::ClothFolding(const Task& task) {
  const JsonFields numbers(task.success.numbers, task.folder + "/task.json: success");
  const std::vector<int> pair = numbers.WholeNumberLists("pairs").at(0);
  taken_ = pair.at(0);
  target_ = pair.at(1);
}

std::vector<Waypoint> ClothFolding::Plan(int leg, const Observation& observation) {
  const Eigen::Vector3d taken = observation.particles.col(taken_);
  const Eigen::Vector3d target = observation.particles.col(target_);
  Eigen::Vector3d way = target - taken;
  way.z() = 0;
  if (!way.allFinite()) throw PolicyError("does not see the cloth");
  if (leg == 0) towards_target_ = way.normalized();
  const double yaw = std::atan2(towards_target_.y(), towards_target_.x());
  const auto at = [&](const Eigen::Vector3d& place, double z, double gripper, int frames) {
    return HandDown({place.x(), place.y(), z}, yaw, gripper, frames);
  };
  if (leg == 0) {
    const Eigen::Vector3d pinch = taken + kPinch * towards_target_;
    return {at(pinch, 0.15, 0, 40), at(pinch, kTable, 0, 30), at(pinch, kTable, 1, 25),
            at(pinch, 0.05, 1, 15), at(pinch + 0.3 * way, kCarry + 0.03, 1, 40)};
  }
  if (leg > 1) return {};
  const Eigen::Vector3d lay = target - (kPinch + kForward) * towards_target_;
  return {at(lay - 0.03 * towards_target_, kCarry, 1, 45), at(lay, kLay, 1, 25),
          at(lay, kLay, 0, 15), at(lay, 0.14, 0, 20)};
}

}  // namespace physpring
