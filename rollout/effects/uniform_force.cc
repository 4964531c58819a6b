// SPDX-License-Identifier: Apache-2.0
// A force on the whole body, shared by mass, constant or swinging in time.
#include <cmath>
#include <numbers>

#include "rollout/effects/scene_effect.h"

namespace physpring {
namespace {

class UniformForce : public SceneEffect {
 public:
  std::string name() const override { return "uniform_force"; }
  std::vector<EffectKey> keys() const override {
    std::vector<EffectKey> keys =
        VectorKeys({"force", -1e3, 1e3, true, "shared by mass: xfrc_applied"}, "n");
    keys.push_back(
        {"period_s", 1e-3, 1e3, false, "the force times sin(2 pi t / period); default: constant"});
    return keys;
  }
  void AddForces(const EffectAmounts& amounts, const SceneBody& body, double time,
                 const mjModel& model, mjData* data) const override {
    const Eigen::Vector3d amplitude = amounts.Vector("force", "n");
    const double period = amounts.At("period_s");
    Eigen::Vector3d force =
        period > 0 ? std::sin(2 * std::numbers::pi * time / period) * amplitude : amplitude;
    AddToBodies(body, model, data, [&](int) -> Eigen::Vector3d { return force; });
  }
  EffectAmounts Trial(const EffectTrial& trial) const override {
    EffectAmounts amounts;
    amounts.SetVector("force", "n", 0.08 * trial.size * trial.sideways);
    amounts.Set("period_s", 0.9);
    return amounts;
  }
};

}  // namespace

std::unique_ptr<SceneEffect> MakeSceneUniformForce() { return std::make_unique<UniformForce>(); }

}  // namespace physpring
