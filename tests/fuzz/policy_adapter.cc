// SPDX-License-Identifier: Apache-2.0
// The text of a policy adapter, for a robot of each kind, up to a request and an action.
#include "rollout/policies/policy_adapter.h"

#include <stdexcept>

#include "rollout/policies/openpi_messages.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/small_twin.h"

namespace physpring {
namespace {

Task TaskOf(RobotKind kind) {
  Task task;
  task.twin = SmallTwin(1);
  task.robot.kind = kind;
  task.robot.hand = "hand";
  task.robot.actuators = {"a", "b"};
  task.robot.fingers = kind == RobotKind::kJoints ? 1 : 2;
  task.robot.open = Eigen::VectorXd::Constant(task.robot.fingers, 0.1);
  task.robot.closed = Eigen::VectorXd::Zero(task.robot.fingers);
  task.cameras = {"c"};
  task.sensors = {"s"};
  return task;
}

Observation Seen(const Task& task) {
  Observation seen;
  seen.robot = task.robot.kind == RobotKind::kJoints ? Eigen::VectorXd::Zero(2)
                                                     : CartesianAction(Pose{}, 0.5);
  seen.joints = Eigen::VectorXd::Zero(task.robot.kind == RobotKind::kJoints ? 1 : 0);
  const SpringMassSystem& system = task.twin.levels[0].system;
  seen.particles = system.position.leftCols(system.node_count());
  seen.sensors["s"] = Eigen::Vector3d(1, 2, 3);
  seen.images["c"] = {3, 2, std::vector<unsigned char>(18, 7)};
  return seen;
}

void Use(const PolicyAdapter& adapter, const Task& task) {
  const Observation seen = Seen(task);
  EncodeObservation(adapter, seen, "push");
  const Eigen::VectorXd numbers = Eigen::VectorXd::Ones(SizeOf(adapter.action, task.robot));
  const Eigen::VectorXd action =
      ToAction(adapter.action, numbers, {task.robot, adapter.frames, seen, seen.robot, 0.1});
  if (action.size() != task.robot.action_size()) throw std::logic_error("another size");
}

}  // namespace
}  // namespace physpring

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace physpring;
  static const std::vector<Task> tasks = {TaskOf(RobotKind::kCartesian),
                                          TaskOf(RobotKind::kJoints)};
  const std::string file = FuzzFolder() + "/adapter.json";
  WriteFuzzFile(file, TextOf(data, size));
  for (const Task& task : tasks) {
    MayRefuse(FuzzFolder(), [&] { Use(ReadPolicyAdapter(file, task), task); });
  }
  return 0;
}

std::vector<std::string> physpring::FuzzSeeds() {
  return {R"({"request":{"o/i":{"camera":"c","size":[8,8],"mirror":true,"layout":"chw"},)"
          R"("o/s":["position","axis_angle","quaternion_wxyz","quaternion_xyzw",)"
          R"({"part":"gripper","open":0.1,"closed":0},{"part":"particles","count":2},)"
          R"({"part":"sensor","sensor":"s"}],"m":{"p":"prompt"}},"action":[)"
          R"({"part":"position_delta","scale":0.1},{"part":"axis_angle_delta","scale":0.5},)"
          R"({"part":"gripper","open":-1,"closed":1,"binary":true},{"part":"unused","count":3}],)"
          R"("clip":1,"execute":5,"frames_per_action":2,"deltas_from":"command",)"
          R"("base":{"position":[1,0,0]},"tool":{"quaternion":[0,1,0,0]}})",
          R"({"request":{"j":["joints","robot"]},"action":["joint_velocity","gripper"],)"
          R"("ensemble":0.01})",
          R"({"request":{"p":"prompt"},"action":["position","quaternion_xyzw"]})",
          R"({"request":{"p":"prompt"},"action":["joints"]})"};
}
