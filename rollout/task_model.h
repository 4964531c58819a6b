// SPDX-License-Identifier: Apache-2.0
// A task's scene with one level of its twin in it, compiled: shared by all episodes and threads.
#ifndef PHYSPRING_ROLLOUT_TASK_MODEL_H_
#define PHYSPRING_ROLLOUT_TASK_MODEL_H_

#include <memory>
#include <string>
#include <vector>

#include "rollout/scene.h"
#include "rollout/success_rule.h"
#include "rollout/task.h"

namespace physpring {

struct TaskModel {
  const Task* task = nullptr;  // lives longer
  int level = 0;
  ModelPtr model;
  int steps = 0;  // MuJoCo's, a frame

  // The object: its nodes are bodies on slide joints, children of one fixed body.
  Pose parent;                 // where that body is
  Points reference;            // 3 x nodes, m: at qpos = 0, in the parent's frame
  std::vector<int> node_qpos;  // where each node's first joint is in qpos

  // The robot. Numbers of what the task names; -1: nothing.
  int target = -1;  // row of mocap_pos
  int hand = -1;
  std::vector<int> actuators;
  std::vector<int> joint_qpos;  // where the actuators' joints are in qpos; -1: drives no joint
  std::vector<int> sensors;     // of Task::sensors

  int success_body = 0;
  std::unique_ptr<const SuccessRule> success;

  int node_count() const { return static_cast<int>(node_qpos.size()); }
  // Where the nodes are: 3 x nodes, m.
  Points NodesIn(const mjData& data) const;
};

// The level's model is attached to the scene in a frame at `task.object`, after all that the scene
// has, and the time step is shortened so that a frame is a whole number of them. Adds MuJoCo's
// warnings to `warnings`, and where the splats lie elsewhere than the nodes. Throws Error, one line
// that begins with a file, when something does not compile or is not there.
TaskModel MakeTaskModel(const Task& task, int level, std::vector<std::string>* warnings);

// A hash of all that the compiled model holds.
std::string HashModel(const mjModel& model);

// A small MJCF file that shows the same scene in any program: it includes the task's scene and
// attaches the level.
std::string FormatSceneFile(const Task& task, int level);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_TASK_MODEL_H_
