// SPDX-License-Identifier: Apache-2.0
#include "rollout/splat_layer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "splats/rasterise.h"
#include "twin/hierarchy.h"

namespace physpring {
namespace {

Points ReferenceNodes(const TaskModel& model) {
  const SpringMassSystem& system = LevelOf(model.task->twin, model.level).system;
  return system.position.leftCols(system.node_count());
}

unsigned char ByteOf(float colour) {
  return static_cast<unsigned char>(std::lround(255 * std::clamp(colour, 0.0F, 1.0F)));
}

}  // namespace

SplatLayer::SplatLayer(const TaskModel& model)
    : model_(model), motion_(*model.splats, ReferenceNodes(model)) {}

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
  const SplatPicture picture =
      Rasterise(motion_.At(model_.NodesIn(data), 1),
                PinholeOf(scene.camera, scene.width, scene.height), backdrop, 1);
  Image image{scene.width, scene.height, std::vector<unsigned char>(3 * pixels)};
  std::transform(picture.rgb.begin(), picture.rgb.end(), image.rgb.begin(), ByteOf);
  return image;
}

PinholeCamera PinholeOf(const mjvGLCamera& camera, int width, int height) {
  const auto vector = [](const float* v) {
    return Eigen::Map<const Eigen::Vector3f>(v).cast<double>();
  };
  const Eigen::Vector3d forward = vector(camera.forward), up = vector(camera.up);
  PinholeCamera pinhole{width, height};
  pinhole.axes.row(0) = forward.cross(up).transpose();
  pinhole.axes.row(1) = -up.transpose();
  pinhole.axes.row(2) = forward.transpose();
  pinhole.shift = -pinhole.axes * vector(camera.pos);
  const double near = camera.frustum_near, top = camera.frustum_top;
  const double bottom = camera.frustum_bottom;
  pinhole.fx = pinhole.fy = height * near / (top - bottom);
  pinhole.cx = 0.5 * width - pinhole.fx * static_cast<double>(camera.frustum_center) / near;
  pinhole.cy = pinhole.fy * top / near;
  return pinhole;
}

float MetricDepth(float depth, const mjvGLCamera& camera) {
  const float near = camera.frustum_near, far = camera.frustum_far;
  return near * far / (far - depth * (far - near));
}

}  // namespace physpring
