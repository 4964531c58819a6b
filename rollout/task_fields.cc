// SPDX-License-Identifier: Apache-2.0
#include "rollout/task_fields.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace physpring {

double FiniteNumber(const JsonFields& fields, const std::string& key) {
  const double number = fields.Number(key);
  if (!std::isfinite(number)) fields.Fail(key, "is not finite");
  return number;
}

double PositiveNumber(const JsonFields& fields, const std::string& key, double missing) {
  if (!fields.Has(key)) return missing;
  const double number = FiniteNumber(fields, key);
  if (number <= 0) fields.Fail(key, "must be above 0");
  return number;
}

Eigen::Vector3d ThreeNumbers(const JsonFields& fields, const std::string& key) {
  const std::vector<double> numbers = fields.Numbers(key);
  if (numbers.size() != 3) fields.Fail(key, "must be three numbers");
  return Eigen::Map<const Eigen::Vector3d>(numbers.data());
}

Pose ReadPose(const JsonFields& fields) {
  fields.ExpectOnly({"position", "quaternion"});
  Pose pose;
  if (fields.Has("position")) pose.position = ThreeNumbers(fields, "position");
  if (!fields.Has("quaternion")) return pose;
  const std::vector<double> q = fields.Numbers("quaternion");
  if (q.size() != 4) fields.Fail("quaternion", "must be four numbers, w x y z");
  constexpr double kLeast = 1e-3;
  if (!(Eigen::Map<const Eigen::Vector4d>(q.data()).norm() > kLeast)) {
    fields.Fail("quaternion", "must not be zero");
  }
  pose.orientation = UnitQuaternion(q[0], q[1], q[2], q[3]);
  return pose;
}

Box ReadBox(const JsonFields& fields) {
  fields.ExpectOnly({"position", "size", "yaw"});
  Box box;
  box.pose.position = ThreeNumbers(fields, "position");
  box.half = ThreeNumbers(fields, "size") / 2;
  if (!(box.half.minCoeff() > 0)) fields.Fail("size", "must be above 0");
  if (fields.Has("yaw")) box.pose.orientation = Yaw(Radians(FiniteNumber(fields, "yaw")));
  return box;
}

double Radians(double degrees) { return degrees * std::numbers::pi / 180; }

}  // namespace physpring
