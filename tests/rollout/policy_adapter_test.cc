// SPDX-License-Identifier: Apache-2.0
// How a policy's names and numbers become ours. Poses are written down by hand.
#include "rollout/policies/policy_adapter.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>

#include "tests/support/small_task.h"
#include "twin/atomic_file.h"
#include "twin/error.h"

namespace physpring {
namespace {

using std::numbers::pi;

class PolicyAdapterTest : public ::testing::Test {
 protected:
  PolicyAdapterTest() {
    task_.Change(R"("robot": {"target": "target", "hand": "hand"})",
                 R"("robot": {"target": "target", "hand": "hand", "actuators": ["a"],
                    "open": [0.04], "closed": [0.0]})");
    read_ = ReadTask(task_.path());
    seen_.hand = {Eigen::Vector3d(0.1, 0.2, 0.3), Yaw(pi / 2)};
    seen_.gripper = 0.25;
    seen_.robot = CartesianAction(seen_.hand, 0.5);
  }

  PolicyAdapter Read(const std::string& text) {
    WriteFileAtomically(task_.File("adapter.json"), text);
    return ReadPolicyAdapter(task_.File("adapter.json"), read_);
  }

  std::string Refusal(const std::string& text) {
    try {
      Read(text);
    } catch (const Error& error) {
      const std::string line = error.what(), file = task_.File("adapter.json") + ": ";
      EXPECT_TRUE(line.starts_with(file)) << line;
      return line.substr(file.size());
    }
    return "";
  }

  std::vector<double> State(const PolicyAdapter& adapter) {
    std::vector<double> state;
    for (const StatePart& part : adapter.request[0].state) {
      AddState(part, seen_, adapter.frames, &state);
    }
    return state;
  }

  Eigen::VectorXd Action(const PolicyAdapter& adapter, const Eigen::VectorXd& numbers) {
    return ToAction(adapter.action, numbers,
                    {read_.robot, adapter.frames, seen_, seen_.robot, 0.1});
  }

  SmallTask task_;
  Task read_;
  Observation seen_;
};

void ExpectNear(const std::vector<double>& found, const std::vector<double>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-12) << i;
}

TEST_F(PolicyAdapterTest, StatesAreInTheOrderOfTheParts) {
  const PolicyAdapter adapter = Read(R"({"request": {"s": [
      {"part": "gripper", "open": 0.04, "closed": 0}, "position", "axis_angle"]},
      "action": ["robot"]})");
  ExpectNear(State(adapter), {0.03, 0.1, 0.2, 0.3, 0, 0, pi / 2});
}

TEST_F(PolicyAdapterTest, QuaternionsBeginOrEndWithTheRealPart) {
  const double half = std::sqrt(0.5);
  ExpectNear(State(Read(R"({"request": {"s": ["quaternion_wxyz"]}, "action": ["robot"]})")),
             {half, 0, 0, half});
  ExpectNear(State(Read(R"({"request": {"s": ["quaternion_xyzw"]}, "action": ["robot"]})")),
             {0, 0, half, half});
}

// The hand 0.1 m up the policy's x axis, which is our y; its tool is 0.05 m down ours.
TEST_F(PolicyAdapterTest, BaseAndToolTurnPoses) {
  const PolicyAdapter adapter = Read(R"({"request": {"s": ["position", "axis_angle"]},
      "action": ["position", "axis_angle"],
      "base": {"position": [0.1, 0.1, 0], "quaternion": [1, 0, 0, 1]},
      "tool": {"position": [0, 0, -0.05]}})");
  ExpectNear(State(adapter), {0.1, 0, 0.25, 0, 0, 0});
  // what it is told is where it is
  Eigen::VectorXd same(6);
  same << 0.1, 0, 0.25, 0, 0, 0;
  EXPECT_TRUE(Action(adapter, same).isApprox(seen_.robot, 1e-12));
}

TEST_F(PolicyAdapterTest, DeltasStartFromTheHandAlongTheBase) {
  const PolicyAdapter adapter = Read(R"({"request": {"s": ["robot"]},
      "action": [{"part": "position_delta", "scale": 0.05},
                 {"part": "axis_angle_delta", "scale": 0.5},
                 {"part": "gripper", "open": -1, "closed": 1}], "clip": 1})");
  Eigen::VectorXd numbers(7);
  numbers << 1, 0, -3, 0, 0, 1, 0.5;  // -3 is clipped to -1
  const Pose expected{Eigen::Vector3d(0.15, 0.2, 0.25), Yaw(pi / 2 + 0.5)};
  EXPECT_TRUE(Action(adapter, numbers).isApprox(CartesianAction(expected, 0.75), 1e-12));
}

TEST_F(PolicyAdapterTest, DeltasMayStartFromTheCommand) {
  const PolicyAdapter adapter = Read(R"({"request": {"s": ["robot"]},
      "action": ["position_delta"], "deltas_from": "command"})");
  seen_.hand.position.setZero();  // the command is at 0.1 0.2 0.3 and keeps its gripper
  const Eigen::VectorXd action = Action(adapter, Eigen::Vector3d(0.01, 0, 0));
  EXPECT_NEAR(action[0], 0.11, 1e-12);
  EXPECT_NEAR(action[7], 0.5, 1e-12);
}

// The hand is measured elsewhere than it was sent: only what is told changes.
TEST_F(PolicyAdapterTest, WhatIsNotToldStaysAsCommanded) {
  seen_.hand = {Eigen::Vector3d(0.11, 0.2, 0.3), Yaw(pi / 2 + 0.1)};
  const Eigen::VectorXd moved = Action(
      Read(R"({"request": {"s": ["robot"]}, "action": ["position"]})"), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(moved.tail(5), seen_.robot.tail(5));
  const Eigen::VectorXd turned = Action(
      Read(R"({"request": {"s": ["robot"]}, "action": ["axis_angle"]})"), Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(turned.head(3), seen_.robot.head(3));
}

TEST_F(PolicyAdapterTest, ABinaryGripperTakesWhatIsNearer) {
  const PolicyAdapter adapter = Read(R"({"request": {"s": ["robot"]},
      "action": [{"part": "unused", "count": 2},
                 {"part": "gripper", "open": 1, "closed": 0, "binary": true}]})");
  EXPECT_EQ(Action(adapter, Eigen::Vector3d(7, 7, 0.4))[7], 1);
  EXPECT_EQ(Action(adapter, Eigen::Vector3d(7, 7, 0.6))[7], 0);
}

TEST_F(PolicyAdapterTest, SomeParticlesAreEvenlySpaced) {
  const PolicyAdapter adapter =
      Read(R"({"request": {"s": [{"part": "particles", "count": 2}]}, "action": ["robot"]})");
  seen_.particles = Points::Zero(3, 5);
  seen_.particles.row(0) << 0, 1, 2, 3, 4;
  ExpectNear(State(adapter), {0, 0, 0, 2, 0, 0});  // 0 and 5 / 2
}

TEST_F(PolicyAdapterTest, JointsMoveFromWhereTheyAre) {
  RobotOptions robot;
  robot.kind = RobotKind::kJoints;
  robot.actuators = {"a", "b", "finger"};
  robot.fingers = 1;
  robot.open = Eigen::VectorXd::Constant(1, 0.04);
  robot.closed = Eigen::VectorXd::Constant(1, 0);
  seen_.joints = Eigen::Vector2d(0.5, -0.5);
  const Eigen::VectorXd command = Eigen::Vector3d(0.6, -0.6, 0.04);
  const auto after = [&](const std::string& part, bool from_command) {
    ActionLayout layout;
    layout.parts = {{.name = part, .scale = 0.2}, {.name = "gripper"}};
    layout.from_command = from_command;
    return ToAction(layout, Eigen::Vector3d(1, -1, 0.5), {robot, {}, seen_, command, 0.1});
  };
  EXPECT_TRUE(after("joint_delta", false).isApprox(Eigen::Vector3d(0.7, -0.7, 0.02), 1e-12));
  EXPECT_TRUE(after("joint_delta", true).isApprox(Eigen::Vector3d(0.8, -0.8, 0.02), 1e-12));
  EXPECT_TRUE(after("joint_velocity", false).isApprox(Eigen::Vector3d(0.52, -0.52, 0.02), 1e-12));
  EXPECT_TRUE(after("joints", false).isApprox(Eigen::Vector3d(1, -1, 0.02), 1e-12));
}

TEST_F(PolicyAdapterTest, WhatIsWrongIsOneLine) {
  const std::string action = R"(, "action": ["robot"]})";
  EXPECT_EQ(Refusal(R"({"request": {"p": "prompt"}})"), "key 'action' must be a list of parts");
  EXPECT_EQ(Refusal(R"({"request": {"s": ["hand"]})" + action),
            "key 'request.s[0].part' holds 'hand', expected one of robot, position, "
            "quaternion_wxyz, quaternion_xyzw, axis_angle, joints, gripper, particles, sensor");
  EXPECT_EQ(Refusal(R"({"request": {"s": ["joints"]})" + action),
            "key 'request.s[0].part' is joints, but the robot is cartesian");
  EXPECT_EQ(Refusal(R"({"request": {"s": {"camera": "roof"}})" + action),
            "key 'request.s.camera' holds 'roof', which is not among the cameras of task.json");
  EXPECT_EQ(Refusal(R"({"request": {"s": [{"part": "sensor", "sensor": "f"}]})" + action),
            "key 'request.s[0].sensor' holds 'f', which is not among the sensors of task.json");
  EXPECT_EQ(Refusal(R"({"request": {"s": 3})" + action),
            "key 'request.s' must be \"prompt\", a picture, a list of parts of the state, or an "
            "object");
  EXPECT_EQ(Refusal(R"({"request": {})" + action), "key 'request' is empty");
  EXPECT_EQ(Refusal(R"({"request": {"p": "prompt"}, "action": ["position", "position_delta"]})"),
            "key 'action' tells where the hand is twice");
  EXPECT_EQ(Refusal(R"({"request": {"p": "prompt"}, "action": ["robot", "gripper"]})"),
            "key 'action' has the part robot, which tells everything, and others");
  EXPECT_EQ(Refusal(R"({"request": {"p": "prompt"}, "action": ["unused"]})"),
            "key 'action' moves nothing");
  EXPECT_EQ(Refusal(R"({"request": {"p": "prompt"},
                        "action": [{"part": "position_delta", "scale": 0}]})"),
            "key 'action[0].scale' must not be 0");
  EXPECT_EQ(Refusal(R"({"request": {"p": "prompt"}, "action": ["joint_delta"]})"),
            "key 'action[0].part' is joint_delta, but the robot is cartesian");
  EXPECT_EQ(Refusal(R"({"request": {"p": "prompt"}, "execute": 3, "ensemble": 0.1)" + action),
            "key 'execute' does not go with ensemble");
  EXPECT_EQ(Refusal(R"({"request": {}, "chunk": 3)" + action).substr(0, 24),
            "key 'chunk' is not known");
}

TEST_F(PolicyAdapterTest, AZeroQuaternionIsThePolicysFault) {
  const PolicyAdapter adapter =
      Read(R"({"request": {"s": ["robot"]}, "action": ["quaternion_wxyz"]})");
  EXPECT_THROW(Action(adapter, Eigen::Vector4d::Zero()), PolicyError);
}

TEST(AxisAngle, IsTheShorterTurn) {
  EXPECT_TRUE(AxisAngle(Yaw(1.5 * pi)).isApprox(Eigen::Vector3d(0, 0, -pi / 2), 1e-12));
  EXPECT_EQ(AxisAngle(Eigen::Quaterniond::Identity()), Eigen::Vector3d::Zero());
  const Eigen::Vector3d turn(0.3, -0.2, 0.9);
  EXPECT_TRUE(AxisAngle(TurnAlong(turn)).isApprox(turn, 1e-12));
}

// Each adapter that is shipped is read for a task that has what it needs.
TEST_F(PolicyAdapterTest, ShippedAdaptersFitTheirTasks) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(PHYSPRING_MODELS "/adapters")) {
    const std::string file = entry.path().string();
    if (!file.ends_with(".json")) continue;
    Task task = read_;
    task.cameras = {"front", "wrist"};
    if (file.ends_with("openpi_droid.json")) {
      task.robot.kind = RobotKind::kJoints;
      task.robot.actuators = {"1", "2", "3", "4", "5", "6", "7", "fingers"};
      EXPECT_EQ(SizeOf(ReadPolicyAdapter(file, task).action, task.robot), 8);
    } else {
      const int size = SizeOf(ReadPolicyAdapter(file, task).action, task.robot);
      EXPECT_EQ(size, file.ends_with("openpi_libero.json") ? 7 : 8) << file;
    }
    ++count;
  }
  EXPECT_EQ(count, 5);
}

}  // namespace
}  // namespace physpring
