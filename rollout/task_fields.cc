// SPDX-License-Identifier: Apache-2.0
#include "rollout/task_fields.h"

#include <fmt/format.h>

#include <numbers>

namespace physpring {

namespace {

Eigen::Vector3d ThreeNumbers(const JsonFields& fields, const std::string& key, double most) {
  const std::vector<double> numbers = NumbersBetween(fields, key, -most, most);
  if (numbers.size() != 3) fields.Fail(key, "must be three numbers");
  return Eigen::Map<const Eigen::Vector3d>(numbers.data());
}

}  // namespace

Pose ReadPose(const JsonFields& fields) {
  fields.ExpectOnly({"position", "quaternion"});
  Pose pose;
  if (fields.Has("position")) pose.position = ThreeNumbers(fields, "position", kFarthest);
  if (!fields.Has("quaternion")) return pose;
  constexpr double kLeast = 1e-3, kMost = 1e3;
  const std::vector<double> q = NumbersBetween(fields, "quaternion", -kMost, kMost);
  if (q.size() != 4) fields.Fail("quaternion", "must be four numbers, w x y z");
  if (!(Eigen::Map<const Eigen::Vector4d>(q.data()).norm() > kLeast)) {
    fields.Fail("quaternion", "must not be zero");
  }
  pose.orientation = UnitQuaternion(q[0], q[1], q[2], q[3]);
  return pose;
}

Box ReadBox(const JsonFields& fields) {
  fields.ExpectOnly({"position", "size", "yaw"});
  Box box;
  box.pose.position = ThreeNumbers(fields, "position", kFarthest);
  box.half = ThreeNumbers(fields, "size", 2 * kFarthest) / 2;
  if (!(box.half.minCoeff() > 0)) fields.Fail("size", "must be above 0");
  if (fields.Has("yaw")) {
    box.pose.orientation = Yaw(Radians(NumberBetween(fields, "yaw", -kTurn, kTurn)));
  }
  return box;
}

double Radians(double degrees) { return degrees * std::numbers::pi / 180; }

}  // namespace physpring
