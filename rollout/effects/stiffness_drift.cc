// SPDX-License-Identifier: Apache-2.0
// All elastic stiffness grows or falls with time.
#include <algorithm>

#include "rollout/effects/scene_effect.h"

namespace physpring {
namespace {

constexpr double kLeastStiffness = 0.1;  // part of it that a drift leaves

class StiffnessDrift : public SceneEffect {
 public:
  std::string name() const override { return "stiffness_drift"; }
  std::vector<EffectKey> keys() const override {
    return {{"relative_rate_per_s", -2, 2, true,
             "all elastic stiffness times 1 + rate t, at least 0.1"}};
  }
  void Drive(const EffectAmounts& amounts, const SceneBody& body, double time,
             mjModel* model) const override {
    const double part = std::max(kLeastStiffness, 1 + amounts.At("relative_rate_per_s") * time);
    const auto scale = [&](const mjtNum* from, auto count, mjtNum* to) {
      for (decltype(count) i = 0; i < count; ++i) to[i] = part * from[i];
    };
    const mjModel& plain = body.plain();
    scale(plain.tendon_stiffness, plain.ntendon, model->tendon_stiffness);
    scale(plain.flex_edgestiffness, plain.nflex, model->flex_edgestiffness);
    scale(plain.flex_stiffness, plain.nflexstiffness, model->flex_stiffness);
    scale(plain.flex_bending, plain.nflexbending, model->flex_bending);
  }
  EffectAmounts Trial(const EffectTrial& trial) const override {
    EffectAmounts amounts;
    amounts.Set("relative_rate_per_s", -0.5 * trial.size);
    return amounts;
  }
};

}  // namespace

std::unique_ptr<SceneEffect> MakeSceneStiffnessDrift() {
  return std::make_unique<StiffnessDrift>();
}

}  // namespace physpring
