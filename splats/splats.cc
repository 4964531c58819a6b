// SPDX-License-Identifier: Apache-2.0
#include "splats/splats.h"

namespace physpring {

PlacedSplats AsStored(const Splats& splats) {
  PlacedSplats placed{&splats, splats.position, {}, {}};
  placed.covariance.resize(6, splats.count());
  for (int i = 0; i < splats.count(); ++i) {
    const Eigen::Vector4f q = splats.rotation.col(i).normalized();
    const Eigen::Matrix3f axes = Eigen::Quaternionf(q[0], q[1], q[2], q[3]).toRotationMatrix();
    const Eigen::Matrix3f scaled =
        axes * splats.log_scale.col(i).array().exp().matrix().asDiagonal();
    const Eigen::Matrix3f s = scaled * scaled.transpose();
    placed.covariance.col(i) << s(0, 0), s(0, 1), s(0, 2), s(1, 1), s(1, 2), s(2, 2);
  }
  return placed;
}

}  // namespace physpring
