// SPDX-License-Identifier: Apache-2.0
#include "splats/splats.h"

namespace physpring {

void Splats::Resize(int count, int highest) {
  degree = highest;
  position.resize(3, count);
  log_scale.resize(3, count);
  rotation.resize(4, count);
  logit.resize(count);
  harmonics.resize(3 * HarmonicCount(degree), count);
}

Eigen::Matrix3f PlacedSplats::Covariance(int i) const {
  const auto s = covariance.col(i);
  Eigen::Matrix3f full;
  full << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5];
  return full;
}

PlacedSplats AsStored(const Splats& splats) {
  PlacedSplats placed{&splats, splats.position, {}, {}};
  placed.covariance.resize(6, splats.count());
  for (int i = 0; i < splats.count(); ++i) {
    const Eigen::Vector4f q = splats.rotation.col(i).normalized();
    const Eigen::Matrix3f axes = Eigen::Quaternionf(q[0], q[1], q[2], q[3]).toRotationMatrix();
    const Eigen::Matrix3f scaled =
        axes * splats.log_scale.col(i).array().exp().matrix().asDiagonal();
    placed.SetCovariance(i, scaled * scaled.transpose());
  }
  return placed;
}

}  // namespace physpring
