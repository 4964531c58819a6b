// SPDX-License-Identifier: Apache-2.0
// OpenGL's cameras and depths, as computer vision has them.
#ifndef PHYSPRING_ROLLOUT_GL_CAMERA_H_
#define PHYSPRING_ROLLOUT_GL_CAMERA_H_

#include <mujoco/mujoco.h>

#include "pictures/camera.h"

namespace physpring {

PinholeCamera PinholeOf(const mjvGLCamera& camera, int width, int height);

// Distance along the view [m] of a value of the depth buffer.
float MetricDepth(float depth, const mjvGLCamera& camera);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_GL_CAMERA_H_
