// SPDX-License-Identifier: Apache-2.0
#include "rollout/policies/t_push.h"

#include <algorithm>
#include <cmath>

#include "rollout/policies/hand_down.h"
#include "rollout/task_fields.h"

namespace physpring {
namespace {

constexpr double kPusher = 0.0375 + 0.006;             // m, radius, and that of the particles
constexpr double kClear = 0.02;                        // m, between pusher and object before a push
constexpr double kLongest = 0.06;                      // m, of a push
constexpr double kHigh = 0.12, kLow = 0.004;           // m, of the pusher's end above the table
constexpr double kBeside = 0.08, kMostBeside = 0.045;  // m a radian, m: of a push from the centre
constexpr double kNear = 0.012, kStraight = 0.12;      // m, rad: close enough
constexpr int kLegs = 12;

using Plane = Eigen::Vector2d;

}  // namespace

TPush::TPush(const Task& task) {
  const JsonFields numbers(task.success.numbers, task.folder + "/task.json: success");
  const SpringMassSystem& object = task.twin.levels[0].system;
  target_ =
      ReadPose(numbers.Object("target")).ToWorld(object.position.leftCols(object.node_count()));
}

std::vector<Waypoint> TPush::Plan(int leg, const Observation& observation) {
  const Points& particles = observation.particles;
  const double turn = YawBetween(particles, target_);  // still to go, rad
  const Plane centre = particles.topRows<2>().rowwise().mean();
  const Plane way = target_.topRows<2>().rowwise().mean() - centre;
  const bool is_near = way.norm() < kNear;
  const bool is_there = is_near && std::abs(turn) < kStraight;
  const Plane here = observation.robot.head<2>();
  const auto at = [&](const Plane& place, double z, int frames) {
    return HandDown({place.x(), place.y(), z}, 0, 0, frames);
  };
  if (is_there || leg >= kLegs) return {at(here, kHigh, 20)};

  // along `ahead`, `beside` to the left of the centre: a push there turns by -beside
  const Plane ahead = is_near ? Plane(1, 0) : Plane(way.normalized());
  const Plane left(-ahead.y(), ahead.x());
  const double beside = std::clamp(-kBeside * turn, -kMostBeside, kMostBeside);
  double back = 0;  // how far back the object lies in the pusher's way
  for (Eigen::Index i = 0; i < particles.cols(); ++i) {
    const Plane from = particles.topRows<2>().col(i) - centre;
    if (std::abs(left.dot(from) - beside) < kPusher) back = std::min(back, ahead.dot(from));
  }
  const double length = is_near ? 0.02 : std::min(way.norm(), kLongest);
  const Plane line = centre + beside * left;
  const Plane start = line + (back - kPusher - kClear) * ahead;
  const Plane end = line + (back - kPusher + length) * ahead;
  return {at(here, kHigh, 8), at(start, kHigh, 25), at(start, kLow, 12), at(end, kLow, 35),
          at(end - 0.03 * ahead, kLow, 10)};
}

}  // namespace physpring
