// SPDX-License-Identifier: Apache-2.0
#include "rollout/policies/rope_routing.h"

#include <cmath>
#include <numbers>

#include "rollout/policies/hand_down.h"

namespace physpring {
namespace {

// Places on the rope, m from its end.
constexpr double kFirst = 0.10, kSecond = 0.30;
constexpr double kHalfSection = 0.012;     // m, of the rope about a place on it
constexpr double kDirectionReach = 0.025;  // m, to both sides, for the rope's direction
// Heights of the hand above the table, m: the pads reach 23 mm below it.
constexpr double kRopeTable = 0.025, kGrip = 0.013;
// Beyond the slot's centre, m: where the first place comes to lie.
constexpr double kBeyond = 0.105;

}  // namespace

RopeRouting::RopeRouting(const Task& task)
    : slot_(ReadBox(JsonFields(task.success.numbers, task.folder).Object("box"))) {
  const Eigen::Vector3d along = slot_.pose.orientation * Eigen::Vector3d::UnitY();
  slot_yaw_ = std::atan2(along.y(), along.x());
  const SpringMassSystem& rope = task.twin.levels[0].system;
  const Points start = task.object.ToWorld(rope.position.leftCols(rope.node_count()));
  arc_ = (along.transpose() * start).transpose();
  arc_ = (arc_.maxCoeff() - arc_.array()).matrix().eval();
}

Eigen::Vector3d RopeRouting::Section(const Points& particles, double arc) const {
  return MeanWhere(particles, (arc_.array() - arc).abs() < kHalfSection);
}

std::vector<Waypoint> RopeRouting::Grasp(const Points& particles, double arc, double height) const {
  const Eigen::Vector3d place = Section(particles, arc);
  const Eigen::Vector3d along =
      Section(particles, arc - kDirectionReach) - Section(particles, arc + kDirectionReach);
  const double yaw = HalfTurnNear(std::atan2(along.y(), along.x()), slot_yaw_);
  const Eigen::Vector3d low(place.x(), place.y(), std::max(kRopeTable, place.z() + kGrip));
  const Eigen::Vector3d high(place.x(), place.y(), height);
  return {HandDown(high, yaw, 0, 40), HandDown(low, yaw, 0, 20), HandDown(low, yaw, 1, 15)};
}

Waypoint RopeRouting::InSlotFrame(double x, double y, double z, double gripper, int frames) const {
  Eigen::Vector3d place = slot_.pose.orientation * Eigen::Vector3d(x, y, 0) + slot_.pose.position;
  place.z() = z;
  return HandDown(place, slot_yaw_, gripper, frames);
}

std::vector<Waypoint> RopeRouting::Plan(int leg, const Observation& observation) {
  const Points& particles = observation.particles;
  if (leg == 0) {
    std::vector<Waypoint> way = Grasp(particles, kFirst, 0.14);
    Eigen::Vector3d up = Section(particles, kFirst);
    up.z() = 0.14;
    way.push_back(HandDown(up, slot_yaw_, 1, 25));
    way.push_back(InSlotFrame(0, kBeyond, 0.12, 1, 45));
    way.push_back(InSlotFrame(0, kBeyond, kRopeTable, 1, 25));
    way.push_back(InSlotFrame(0, kBeyond, kRopeTable, 0, 12));
    way.push_back(InSlotFrame(0, kBeyond, 0.13, 0, 20));
    return way;
  }
  if (leg > 1) return {};
  // where the first place lies, and the line from there through the slot
  const Eigen::Vector3d first = slot_.pose.ToLocal(Section(particles, kFirst));
  const Eigen::Vector3d second = slot_.pose.ToLocal(Section(particles, kSecond));
  const double span = kSecond - kFirst, x = -0.5 * first.x();
  const double y =
      first.y() - std::sqrt(std::max(0.0, span * span - std::pow(x - first.x(), 2))) + 0.003;
  std::vector<Waypoint> way = Grasp(particles, kSecond, 0.13);
  way.push_back(InSlotFrame(0.7 * second.x() + 0.3 * x, second.y() + 0.01, 0.09, 1, 20));
  way.push_back(InSlotFrame(x + 0.01, -0.02, 0.13, 1, 30));
  way.push_back(InSlotFrame(x, y + 0.035, 0.09, 1, 20));
  way.push_back(InSlotFrame(x, y, kRopeTable, 1, 25));
  way.push_back(InSlotFrame(x, y, kRopeTable, 0, 12));
  way.push_back(InSlotFrame(x, y, 0.14, 0, 20));
  return way;
}

}  // namespace physpring
