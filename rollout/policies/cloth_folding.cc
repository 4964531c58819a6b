// SPDX-License-Identifier: Apache-2.0
#include "rollout/policies/cloth_folding.h"

#include <cmath>

#include "rollout/policies/hand_down.h"
#include "rollout/task_fields.h"

namespace physpring {
namespace {

// The pads come down to both sides of the way to the target, so far from the particle that is
// taken, and close: the cloth between them buckles up.
constexpr double kPinch = 0.03;  // m
// m, of the hand: the pads end 1 mm above the table. Pressed on it, friction holds them open until
// the hand goes up, and what they then still find between them is chance.
constexpr double kClothTable = 0.024;
constexpr double kLay = 0.045;  // m, of the hand where it opens
// The arc is that much tighter than the cloth would allow: what hangs slack falls forward, m.
constexpr double kSlack = 0.01;

}  // namespace

ClothFolding::ClothFolding(const Task& task) {
  const JsonFields numbers(task.success.numbers, task.folder + "/task.json: success");
  const std::vector<int> pair = numbers.WholeNumberLists("pairs").at(0);
  taken_ = pair.at(0);
  target_ = pair.at(1);
}

std::vector<Waypoint> ClothFolding::Plan(int leg, const Observation& observation) {
  if (leg > 0) return {};
  Eigen::Vector3d taken = observation.particles.col(taken_);
  Eigen::Vector3d target = observation.particles.col(target_);
  taken.z() = target.z() = 0;
  const double apart = (target - taken).norm();
  if (!(apart > 2 * (kPinch + kSlack))) throw PolicyError("does not see the cloth spread out");
  const Eigen::Vector3d along = (target - taken) / apart;
  const double yaw = std::atan2(along.y(), along.x());
  const auto at = [&](const Eigen::Vector3d& place, double z, double gripper, int frames) {
    return HandDown({place.x(), place.y(), z}, yaw, gripper, frames);
  };
  const Eigen::Vector3d pinch = taken + kPinch * along, middle = (taken + target) / 2;
  std::vector<Waypoint> way = {at(pinch, 0.15, 0, 40), at(pinch, kClothTable, 0, 30),
                               at(pinch, kClothTable, 1, 25)};
  const double radius = apart / 2 - kPinch - kSlack;
  for (const double degrees : {25, 55, 90, 125, 150}) {
    const double angle = Radians(degrees);
    way.push_back(at(middle - radius * std::cos(angle) * along,
                     kClothTable + radius * std::sin(angle), 1, 20));
  }
  const Eigen::Vector3d lay = middle + radius * along;
  for (const Waypoint& last : {at(lay, kLay, 1, 20), at(lay, kLay, 0, 18),
                               at(lay, kLay + 0.03, 0, 30), at(lay, 0.14, 0, 20)}) {
    way.push_back(last);
  }
  return way;
}

}  // namespace physpring
