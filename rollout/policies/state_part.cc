// SPDX-License-Identifier: Apache-2.0
#include "rollout/policies/state_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "rollout/task_fields.h"
#include "twin/quote.h"

namespace physpring {
namespace {

using Numbers = std::vector<double>;

void AddAll(const Eigen::VectorXd& numbers, Numbers* state) {
  state->insert(state->end(), numbers.begin(), numbers.end());
}

Pose Hand(const Observation& observation, const PolicyFrames& frames) {
  const Pose& base = frames.base;
  const Eigen::Quaterniond back = base.orientation.conjugate();
  return Pose{back * -base.position, back} * observation.hand * frames.tool;
}

void AddRobot(const StatePart&, const Observation& seen, const PolicyFrames&, Numbers* state) {
  AddAll(seen.robot, state);
}

void AddPosition(const StatePart&, const Observation& seen, const PolicyFrames& frames,
                 Numbers* state) {
  AddAll(Hand(seen, frames).position, state);
}

void AddQuaternion(const StatePart& part, const Observation& seen, const PolicyFrames& frames,
                   Numbers* state) {
  const Eigen::Quaterniond q = Hand(seen, frames).orientation;
  if (part.name == "quaternion_wxyz") state->push_back(q.w());
  AddAll(q.vec(), state);
  if (part.name == "quaternion_xyzw") state->push_back(q.w());
}

void AddAxisAngle(const StatePart&, const Observation& seen, const PolicyFrames& frames,
                  Numbers* state) {
  AddAll(AxisAngle(Hand(seen, frames).orientation), state);
}

void AddJoints(const StatePart&, const Observation& seen, const PolicyFrames&, Numbers* state) {
  AddAll(seen.joints, state);
}

void AddGripper(const StatePart& part, const Observation& seen, const PolicyFrames&,
                Numbers* state) {
  state->push_back(part.open + seen.gripper * (part.closed - part.open));
}

void AddParticles(const StatePart& part, const Observation& seen, const PolicyFrames&,
                  Numbers* state) {
  const Eigen::Index all = seen.particles.cols();
  const Eigen::Index count = part.count == 0 ? all : part.count;
  for (Eigen::Index i = 0; i < count; ++i) AddAll(seen.particles.col(i * all / count), state);
}

void AddSensor(const StatePart& part, const Observation& seen, const PolicyFrames&,
               Numbers* state) {
  AddAll(seen.sensors.at(part.sensor), state);
}

using Add = void (*)(const StatePart&, const Observation&, const PolicyFrames&, Numbers*);

const std::map<std::string, Add>& Parts() {
  static const std::map<std::string, Add> parts = {
      {"robot", AddRobot},
      {"position", AddPosition},
      {"quaternion_wxyz", AddQuaternion},
      {"quaternion_xyzw", AddQuaternion},
      {"axis_angle", AddAxisAngle},
      {"joints", AddJoints},
      {"gripper", AddGripper},
      {"particles", AddParticles},
      {"sensor", AddSensor},
  };
  return parts;
}

void ExpectInTask(const StatePart& part, const JsonFields& fields, const Task& task) {
  const bool of_hand =
      part.name == "position" || part.name == "axis_angle" || part.name.starts_with("quaternion");
  if (of_hand && task.robot.hand.empty())
    fields.Fail("part", "needs the robot's hand in task.json");
  if (part.name == "joints" && task.robot.kind != RobotKind::kJoints) {
    fields.Fail("part", "is joints, but the robot is cartesian");
  }
  if (part.name == "gripper" && task.robot.open.size() == 0) {
    fields.Fail("part", "is gripper, but the robot has none");
  }
}

}  // namespace

StatePart ReadStatePart(const JsonFields& fields, const Task& task) {
  StatePart part{.name = fields.Text("part")};
  if (!Parts().contains(part.name)) {
    fields.Fail("part",
                fmt::format("holds {}, expected one of robot, position, quaternion_wxyz, "
                            "quaternion_xyzw, axis_angle, joints, gripper, particles, sensor",
                            Quote(part.name)));
  }
  ExpectInTask(part, fields, task);
  if (part.name == "gripper") {
    fields.ExpectOnly({"part", "open", "closed"});
    if (fields.Has("open")) part.open = NumberBetween(fields, "open", -1e6, 1e6);
    if (fields.Has("closed")) part.closed = NumberBetween(fields, "closed", -1e6, 1e6);
  } else if (part.name == "particles") {
    fields.ExpectOnly({"part", "count"});
    const int all = task.twin.levels[0].system.node_count();
    if (fields.Has("count")) part.count = CountBetween(fields, "count", 1, all);
  } else if (part.name == "sensor") {
    fields.ExpectOnly({"part", "sensor"});
    part.sensor = fields.Text("sensor");
    const auto& sensors = task.sensors;
    if (std::find(sensors.begin(), sensors.end(), part.sensor) == sensors.end()) {
      fields.Fail("sensor", fmt::format("holds {}, which is not among the sensors of task.json",
                                        Quote(part.sensor)));
    }
  } else {
    fields.ExpectOnly({"part"});
  }
  return part;
}

void AddState(const StatePart& part, const Observation& observation, const PolicyFrames& frames,
              std::vector<double>* state) {
  Parts().at(part.name)(part, observation, frames, state);
}

Eigen::Vector3d AxisAngle(const Eigen::Quaterniond& turn) {
  const double sign = turn.w() < 0 ? -1 : 1;
  const double sine = turn.vec().norm();
  if (sine < 1e-12) return 2 * sign * turn.vec();
  return 2 * std::atan2(sine, sign * turn.w()) * sign / sine * turn.vec();
}

Eigen::Quaterniond TurnAlong(const Eigen::Vector3d& axis_angle) {
  const double angle = axis_angle.norm();
  if (angle < 1e-12) {
    return UnitQuaternion(1, axis_angle.x() / 2, axis_angle.y() / 2, axis_angle.z() / 2);
  }
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis_angle / angle));
}

}  // namespace physpring
