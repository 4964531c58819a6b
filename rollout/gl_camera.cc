// SPDX-License-Identifier: Apache-2.0
#include "rollout/gl_camera.h"

#include <Eigen/Geometry>

namespace physpring {

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
