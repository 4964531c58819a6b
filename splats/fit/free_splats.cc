// SPDX-License-Identifier: Apache-2.0
#include "splats/fit/free_splats.h"

#include "splats/harmonics.h"

namespace physpring {

Splats StoredSplats(const FreeSplats& free) {
  double constant = 0;
  Harmonics(0, Eigen::Vector3d(0, 0, 1), &constant);
  Splats splats;
  splats.Resize(static_cast<int>(free.cols()), 0);
  splats.position = free.middleRows<3>(kFreePosition).cast<float>();
  splats.log_scale = free.middleRows<3>(kFreeScale).cast<float>();
  splats.rotation = free.middleRows<4>(kFreeRotation).colwise().normalized().cast<float>();
  splats.logit = free.row(kFreeLogit).transpose().cast<float>();
  splats.harmonics = ((free.middleRows<3>(kFreeColour).array() - 0.5) / constant).cast<float>();
  return splats;
}

}  // namespace physpring
