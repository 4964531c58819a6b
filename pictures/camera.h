// SPDX-License-Identifier: Apache-2.0
// A pinhole camera, as computer vision has it: x to the right, y down, z into the picture.
#ifndef PHYSPRING_PICTURES_CAMERA_H_
#define PHYSPRING_PICTURES_CAMERA_H_

#include <Eigen/Core>

namespace physpring {

struct PinholeCamera {
  int width = 0, height = 0;  // pixels
  // A point of the world p is at t = axes p + shift in the camera, and at pixel
  //   u = fx t.x / t.z + cx,   v = fy t.y / t.z + cy,
  // where the centre of the first pixel is at (0.5, 0.5).
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // m
  double fx = 1, fy = 1, cx = 0, cy = 0;            // pixels

  Eigen::Vector3d centre() const { return -axes.transpose() * shift; }
};

}  // namespace physpring

#endif  // PHYSPRING_PICTURES_CAMERA_H_
