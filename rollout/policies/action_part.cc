// SPDX-License-Identifier: Apache-2.0
#include "rollout/policies/action_part.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "rollout/task_fields.h"
#include "twin/quote.h"

namespace physpring {
namespace {

using Vector = Eigen::VectorXd;

// What an action has been made of so far.
struct Draft {
  Vector* action;
  Pose hand;  // of the policy's tool in its base, for the parts that set one half of it
  bool has_position = false, has_orientation = false;
};

Pose Inverse(const Pose& pose) {
  const Eigen::Quaterniond back = pose.orientation.conjugate();
  return {back * -pose.position, back};
}

// Where the policy's tool is, as deltas take it.
Pose StartOfHand(const ActionLayout& layout, const ActionContext& context) {
  Pose hand = context.observation.hand;
  if (layout.from_command) {
    const Vector& c = context.command;
    hand = {c.head<3>(), UnitQuaternion(c[3], c[4], c[5], c[6])};
  }
  return Inverse(context.frames.base) * hand * context.frames.tool;
}

int JointCount(const RobotOptions& robot) {
  return static_cast<int>(robot.actuators.size()) - robot.fingers;
}

void SetHandPart(const ActionPart& part, const Vector& q, Draft* draft) {
  Pose& hand = draft->hand;
  (part.name.starts_with("position") ? draft->has_position : draft->has_orientation) = true;
  if (part.name == "position") {
    hand.position = q;
  } else if (part.name == "position_delta") {
    hand.position += part.scale * q;
  } else if (part.name == "axis_angle") {
    hand.orientation = TurnAlong(q);
  } else if (part.name == "axis_angle_delta") {
    hand.orientation = TurnAlong(part.scale * q) * hand.orientation;
  } else {
    constexpr double kLeastNorm = 1e-3;
    if (!(q.norm() > kLeastNorm)) {
      throw PolicyError(fmt::format("the policy's quaternion has length {:.3g}", q.norm()));
    }
    const bool real_first = part.name == "quaternion_wxyz";
    hand.orientation = real_first ? UnitQuaternion(q[0], q[1], q[2], q[3])
                                  : UnitQuaternion(q[3], q[0], q[1], q[2]);
  }
}

void SetJoints(const ActionPart& part, const Vector& q, const ActionLayout& layout,
               const ActionContext& context, Draft* draft) {
  auto joints = draft->action->head(q.size());
  if (part.name == "joints") {
    joints = q;
    return;
  }
  const Vector start =
      layout.from_command ? Vector(context.command.head(q.size())) : context.observation.joints;
  const double time = part.name == "joint_velocity" ? context.seconds : 1;
  joints = start + part.scale * time * q;
}

void SetGripper(const ActionPart& part, double value, const RobotOptions& robot, Draft* draft) {
  double closed = std::clamp((value - part.open) / (part.closed - part.open), 0.0, 1.0);
  if (part.binary) closed = closed > 0.5 ? 1 : 0;
  if (robot.kind == RobotKind::kCartesian) {
    draft->action->tail<1>()[0] = closed;
  } else {
    draft->action->tail(robot.fingers) = robot.open + closed * (robot.closed - robot.open);
  }
}

// How many numbers each part has, by its name; 0: that depends.
const std::map<std::string, int>& Sizes() {
  static const std::map<std::string, int> sizes = {{"robot", 0},
                                                   {"position", 3},
                                                   {"position_delta", 3},
                                                   {"quaternion_wxyz", 4},
                                                   {"quaternion_xyzw", 4},
                                                   {"axis_angle", 3},
                                                   {"axis_angle_delta", 3},
                                                   {"joints", 0},
                                                   {"joint_delta", 0},
                                                   {"joint_velocity", 0},
                                                   {"gripper", 1},
                                                   {"unused", 0}};
  return sizes;
}

int SizeOfPart(const ActionPart& part, const RobotOptions& robot) {
  if (part.name == "robot") return robot.action_size();
  if (part.name == "unused") return part.count;
  if (part.name.starts_with("joint")) return JointCount(robot);
  return Sizes().at(part.name);
}

}  // namespace

ActionPart ReadActionPart(const JsonFields& fields, const RobotOptions& robot) {
  ActionPart part{.name = fields.Text("part")};
  if (!Sizes().contains(part.name)) {
    std::vector<std::string> names;
    for (const auto& [name, size] : Sizes()) names.push_back(name);
    fields.Fail("part", fmt::format("holds {}, expected one of {}", Quote(part.name),
                                    fmt::join(names, ", ")));
  }
  const bool of_joints = part.name.starts_with("joint"), is_gripper = part.name == "gripper";
  const bool of_any = part.name == "robot" || part.name == "unused" || is_gripper;
  if (!of_any && of_joints != (robot.kind == RobotKind::kJoints)) {
    fields.Fail("part", fmt::format("is {}, but the robot is {}", part.name,
                                    of_joints ? "cartesian" : "driven by joints"));
  }
  if (is_gripper && robot.open.size() == 0) {
    fields.Fail("part", "is gripper, but the robot has none");
  }
  if (is_gripper) {
    fields.ExpectOnly({"part", "open", "closed", "binary"});
    if (fields.Has("open")) part.open = NumberBetween(fields, "open", -1e6, 1e6);
    if (fields.Has("closed")) part.closed = NumberBetween(fields, "closed", -1e6, 1e6);
    if (part.open == part.closed) fields.Fail("closed", "must differ from open");
    if (fields.Has("binary")) part.binary = fields.Flag("binary");
  } else if (part.name == "unused") {
    fields.ExpectOnly({"part", "count"});
    if (fields.Has("count")) part.count = CountBetween(fields, "count", 1, 1000);
  } else if (part.name.ends_with("_delta") || part.name == "joint_velocity") {
    fields.ExpectOnly({"part", "scale"});
    if (fields.Has("scale")) part.scale = NumberBetween(fields, "scale", -1e6, 1e6);
    if (part.scale == 0) fields.Fail("scale", "must not be 0");
  } else {
    fields.ExpectOnly({"part"});
  }
  return part;
}

int SizeOf(const ActionLayout& layout, const RobotOptions& robot) {
  int size = 0;
  for (const ActionPart& part : layout.parts) size += SizeOfPart(part, robot);
  return size;
}

Vector ToAction(const ActionLayout& layout, const Vector& numbers, const ActionContext& context) {
  if (!numbers.allFinite()) {
    throw PolicyError("the policy's action has numbers that are not finite");
  }
  const RobotOptions& robot = context.robot;
  const Vector clipped = numbers.cwiseMax(-layout.clip).cwiseMin(layout.clip);
  Vector action = context.command;
  Draft draft{&action, {}};
  if (robot.kind == RobotKind::kCartesian) draft.hand = StartOfHand(layout, context);
  Eigen::Index place = 0;
  for (const ActionPart& part : layout.parts) {
    const Vector own = clipped.segment(place, SizeOfPart(part, robot));
    place += own.size();
    if (part.name == "robot") {
      action = own;
    } else if (part.name.starts_with("joint")) {
      SetJoints(part, own, layout, context, &draft);
    } else if (part.name == "gripper") {
      SetGripper(part, own[0], robot, &draft);
    } else if (part.name != "unused") {
      SetHandPart(part, own, &draft);
    }
  }
  if (!draft.has_position && !draft.has_orientation) return action;
  const Pose hand = context.frames.base * draft.hand * Inverse(context.frames.tool);
  const Vector wished = CartesianAction(hand, 0);
  if (draft.has_position) action.head<3>() = wished.head<3>();
  if (draft.has_orientation) action.segment<4>(3) = wished.segment<4>(3);
  return action;
}

}  // namespace physpring
