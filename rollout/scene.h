// SPDX-License-Identifier: Apache-2.0
// A MuJoCo scene in memory: owners of its model and data, and how they are made without MuJoCo
// ending the process.
#ifndef PHYSPRING_ROLLOUT_SCENE_H_
#define PHYSPRING_ROLLOUT_SCENE_H_

#include <mujoco/mujoco.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace physpring {

struct DeleteModel {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
};
struct DeleteData {
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using ModelPtr = std::unique_ptr<mjModel, DeleteModel>;
using DataPtr = std::unique_ptr<mjData, DeleteData>;

// Reads and compiles the MJCF file `path`; adds what the compiler warns of to `warnings`. Throws
// Error, one line that begins with `path`, when it is not readable or does not compile.
ModelPtr LoadScene(const std::string& path, std::vector<std::string>* warnings);

// The same after `edit`; of a file, or of MJCF in memory, which `where` stands for in messages.
// What the compiler warns of is an Error in the second one, and left out in the first.
using SceneEdit = std::function<void(mjSpec*)>;
ModelPtr EditScene(const std::string& path, const SceneEdit& edit);
ModelPtr CompileScene(const std::string& mjcf, const std::string& where, const SceneEdit& edit);

// Shortens the time step so that a frame is a whole number of them, which it returns. Throws Error
// where that are more than a million.
int FitTimestep(double fps, mjModel* model);

// Throws Error when the model needs more memory than there is.
DataPtr MakeData(const mjModel& model);

// One mj_step. Throws Error with MuJoCo's message at any warning or error: bad numbers (an unstable
// simulation), full contact or constraint buffers.
void Step(const mjModel& model, mjData* data);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_SCENE_H_
