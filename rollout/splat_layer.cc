// SPDX-License-Identifier: Apache-2.0
#include "rollout/splat_layer.h"

#include "rollout/gl_camera.h"
#include "splats/picture_bytes.h"
#include "splats/rasterise.h"
#include "twin/hierarchy.h"

namespace physpring {
namespace {

Points ReferenceNodes(const TaskModel& model) {
  const SpringMassSystem& system = LevelOf(model.task->twin, model.level).system;
  return system.position.leftCols(system.node_count());
}

}  // namespace

SplatLayer::SplatLayer(const TaskModel& model) : model_(model) {
  const TaskSplats& splats = model.task->splats;
  if (splats.object) motion_.emplace(*splats.object, ReferenceNodes(model));
  if (splats.background) still_ = AsStored(*splats.background);
}

Image SplatLayer::Compose(const DrawnScene& scene, const mjData& data) const {
  const std::size_t pixels = static_cast<std::size_t>(scene.width) * scene.height;
  Backdrop backdrop{std::vector<float>(3 * pixels), std::vector<float>(pixels)};
  for (int y = 0; y < scene.height; ++y) {
    const std::size_t to = static_cast<std::size_t>(y) * scene.width;
    const std::size_t from = static_cast<std::size_t>(scene.height - 1 - y) * scene.width;
    for (int x = 0; x < scene.width; ++x) {
      backdrop.depth[to + x] = MetricDepth(scene.depth[from + x], scene.camera);
      for (int c = 0; c < 3; ++c) {
        backdrop.rgb[3 * (to + x) + c] = static_cast<float>(scene.rgb[3 * (from + x) + c]) / 255;
      }
    }
  }
  PlacedSplats moved;
  std::vector<const PlacedSplats*> groups;
  if (motion_) {
    moved = motion_->At(model_.NodesIn(data), 1);
    groups.push_back(&moved);
  }
  if (still_) groups.push_back(&*still_);
  return BytesOf(
      Rasterise(groups, PinholeOf(scene.camera, scene.width, scene.height), backdrop, 1));
}

}  // namespace physpring
