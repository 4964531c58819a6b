// SPDX-License-Identifier: Apache-2.0
#include "rollout/policies/toy_packing.h"

#include <cmath>

#include "rollout/policies/hand_down.h"

namespace physpring {
namespace {

constexpr double kToyTable = 0.027;                    // m, of the hand, for what lies on the table
constexpr double kClearOfBox = 0.13, kRelease = 0.04;  // m, of the hand above the box's edge

}  // namespace

ToyPacking::ToyPacking(const Task& task)
    : box_(ReadBox(JsonFields(task.success.numbers, task.folder).Object("box"))) {
  const SpringMassSystem& toy = task.twin.levels[0].system;
  reference_ = toy.position.leftCols(toy.node_count());
}

std::vector<Waypoint> ToyPacking::Plan(int leg, const Observation& observation) {
  if (leg > 0) return {};
  const Eigen::Vector3d toy = observation.particles.rowwise().mean();
  const Eigen::Vector3d along = box_.pose.orientation * Eigen::Vector3d::UnitX();
  const double box_yaw = std::atan2(along.y(), along.x());
  const double toy_yaw = HalfTurnNear(YawBetween(reference_, observation.particles), box_yaw);
  const auto at_toy = [&](double z, double gripper, int frames) {
    return HandDown({toy.x(), toy.y(), z}, toy_yaw, gripper, frames);
  };
  const double edge = box_.pose.position.z() + box_.half.z();
  const auto at_box = [&](double above, double gripper, int frames) {
    const Eigen::Vector3d place(box_.pose.position.x(), box_.pose.position.y(), edge + above);
    return HandDown(place, box_yaw, gripper, frames);
  };
  return {at_toy(0.16, 0, 45),     at_toy(kToyTable, 0, 25),          at_toy(kToyTable, 1, 25),
          at_toy(0.2, 1, 30),      at_toy(edge + kClearOfBox, 1, 35), at_box(kClearOfBox, 1, 50),
          at_box(kRelease, 1, 25), at_box(kRelease, 0, 12),           at_box(kClearOfBox, 0, 20)};
}

}  // namespace physpring
