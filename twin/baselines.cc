// SPDX-License-Identifier: Apache-2.0
#include "twin/baselines.h"

#include "twin/rotation.h"

namespace physpring {

std::vector<Baseline> PredictBaselines(const Recording& recording, const LinearPredictor& linear) {
  const Points start = recording.start.leftCols(recording.particle_count());
  const int frames = recording.frame_count();
  std::vector<Baseline> baselines;
  baselines.push_back({"motionless", "a body that does not move", {}});
  baselines[0].particles.assign(frames, start);
  if (recording.controller_count() == 0) return baselines;

  Baseline rigid{"rigid", "a rigid body that goes with the controllers", {}};
  for (int t = 0; t < frames; ++t) {
    rigid.particles.push_back(
        MoveRigidly(recording.controllers[0], recording.controllers[t], start));
  }
  if (!linear.empty()) {
    Baseline regression{"linear", "a linear regression on the controllers", rigid.particles};
    const std::vector<Points> points = PredictLinearly(linear, recording);
    for (int t = 0; t < frames; ++t) {
      regression.particles[t].leftCols(recording.point_count()) = points[t];
    }
    baselines.push_back(std::move(rigid));
    baselines.push_back(std::move(regression));
  } else {
    baselines.push_back(std::move(rigid));
  }
  return baselines;
}

}  // namespace physpring
