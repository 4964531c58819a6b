// SPDX-License-Identifier: Apache-2.0
// A task: a folder with a MuJoCo scene, the levels of a twin, and `task.json`, which says where the
// object lies, how the robot is driven, where episodes start and what counts as success
// (docs/rollout.md has every key).
#ifndef PHYSPRING_ROLLOUT_TASK_H_
#define PHYSPRING_ROLLOUT_TASK_H_

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "rollout/pose.h"
#include "splats/splats.h"
#include "twin/twin.h"

namespace physpring {

// How actions become the scene's controls.
enum class RobotKind {
  kCartesian,  // 8 numbers x y z qw qx qy qz gripper: the pose of a mocap body, and fingers
  kJoints,     // one number an actuator
};

struct RobotOptions {
  RobotKind kind = RobotKind::kCartesian;
  std::string target;  // mocap body that the hand is welded to (kCartesian)
  std::string hand;    // site whose pose is the robot's state; may be missing with kJoints
  std::vector<std::string>
      actuators;    // the fingers' (kCartesian), or all that are driven (kJoints)
  int fingers = 0;  // so many of the last actuators are the gripper's; all of them with kCartesian
  Eigen::VectorXd open, closed;  // (fingers), ctrl at gripper 0 and 1
  Eigen::VectorXd home;          // the action while the scene settles; empty: as the scene is
  double speed = 0.5;            // m/s, at most, of the target (kCartesian)
  double turn_speed = 3;         // rad/s, at most, of the target (kCartesian)
  double gripper_speed = 2;      // 1/s, at most, of the gripper's range (kCartesian)

  int action_size() const;  // numbers in an action
};

// Places where the object starts, relative to Task::object: each x with each y with each yaw, plus
// noise, uniform between -noise and noise.
struct StartOptions {
  std::vector<double> x{0}, y{0}, yaw{0};  // m, m, rad
  double noise_xy = 0, noise_yaw = 0;      // m, rad; ReadTask: 2 mm, 1 degree unless given

  int cells() const;  // how many the grid has
};

struct SuccessOptions {
  std::string rule;            // its name: see success_rule.h
  std::string body;            // in whose frame the rule's numbers are; empty: the world's
  int from_frame = 0;          // frames before this one do not count
  int at_least = 1;            // frames in which the rule must be met, not necessarily in a row
  std::string numbers = "{}";  // the rule's own, a JSON object
};

// What is drawn as splats (splats/splats.h).
struct TaskSplats {
  std::string file;                          // of the object
  std::shared_ptr<const Splats> object;      // instead of its skin, in the twin's frame; null: none
  std::shared_ptr<const Splats> background;  // a room, in the world; null: none

  bool any() const { return object || background; }
};

struct Task {
  std::string name;
  std::string folder;
  std::string prompt;               // the task in words, for policies that read
  std::string scene;                // path of the MJCF without the object
  Twin twin;                        // the object
  std::vector<std::string> levels;  // paths of the exported levels, level 0 first
  Pose object;                      // where the twin's reference configuration is in the scene
  double rate = 30;                 // Hz, of control; a frame lasts 1 / rate
  int settle = 30;                  // frames before frame 0, the robot at home
  int frames = 900;                 // how many an episode has
  RobotOptions robot;
  StartOptions starts;
  SuccessOptions success;
  std::string policy;                // the scripted policy, see policies/registry.h
  std::string policy_adapter;        // file, for policy servers; empty: plain
  std::vector<std::string> sensors;  // names in the scene, for policies that ask for them
  TaskSplats splats;
  std::vector<std::string> cameras;  // names in the scene; the first one makes the video
  int width = 640, height = 480;     // pixels, of what cameras see
};

// Reads FOLDER/task.json and the twin that it names. Throws Error, one line that begins with the
// file, when something is missing, unknown or out of range.
Task ReadTask(const std::string& folder);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_TASK_H_
