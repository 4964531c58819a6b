// SPDX-License-Identifier: Apache-2.0
// Splats in MuJoCo's pictures: before and behind what MuJoCo draws, by its depth buffer, so that
// grippers hide them and they hide grippers. Those of a task's object move with its nodes, those of
// the background stand.
#ifndef PHYSPRING_ROLLOUT_SPLAT_LAYER_H_
#define PHYSPRING_ROLLOUT_SPLAT_LAYER_H_

#include <mujoco/mujoco.h>

#include <optional>
#include <vector>

#include "pictures/image.h"
#include "rollout/task_model.h"
#include "splats/splat_motion.h"

namespace physpring {

// What MuJoCo has drawn, as OpenGL gives it: the bottom row first.
struct DrawnScene {
  int width = 0, height = 0;
  std::vector<unsigned char> rgb;
  std::vector<float> depth;  // of the depth buffer, 0 near to 1 far
  mjvGLCamera camera;        // that it was drawn with
};

class SplatLayer {
 public:
  // Of a model whose task has splats, which lives longer.
  explicit SplatLayer(const TaskModel& model);
  SplatLayer(const SplatLayer&) = delete;
  SplatLayer& operator=(const SplatLayer&) = delete;

  bool has_object() const { return motion_.has_value(); }

  // Where something is drawn as the nodes of `data` have it.
  Image Compose(const DrawnScene& scene, const mjData& data) const;

 private:
  const TaskModel& model_;
  std::optional<SplatMotion> motion_;  // of the object
  std::optional<PlacedSplats> still_;  // the background
};

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_SPLAT_LAYER_H_
