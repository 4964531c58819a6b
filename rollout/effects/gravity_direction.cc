// SPDX-License-Identifier: Apache-2.0
// Gravity in another direction: MuJoCo's option.
#include <Eigen/Geometry>

#include "rollout/effects/scene_effect.h"

namespace physpring {
namespace {

class GravityDirection : public SceneEffect {
 public:
  std::string name() const override { return "gravity_direction"; }
  std::vector<EffectKey> keys() const override {
    return {{"tilt_x_rad", -1.5, 1.5, true, "gravity is turned about x"},
            {"tilt_y_rad", -1.5, 1.5, true, "gravity is turned about y"}};
  }
  void Change(const EffectAmounts& amounts, const SceneBody&, mjModel* model) const override {
    const Eigen::Vector3d turn(amounts.At("tilt_x_rad"), amounts.At("tilt_y_rad"), 0);
    Eigen::Map<Eigen::Vector3d> gravity(model->opt.gravity);
    gravity = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * Eigen::Vector3d(gravity);
  }
  EffectAmounts Trial(const EffectTrial& trial) const override {
    EffectAmounts amounts;
    amounts.Set("tilt_x_rad", 0.12 * trial.size * trial.sideways[1]);
    amounts.Set("tilt_y_rad", -0.12 * trial.size * trial.sideways[0]);
    return amounts;
  }
};

}  // namespace

std::unique_ptr<SceneEffect> MakeSceneGravityDirection() {
  return std::make_unique<GravityDirection>();
}

}  // namespace physpring
