// SPDX-License-Identifier: Apache-2.0
// Mocap bodies that move later than the recording tells.
#include "rollout/effects/scene_effect.h"

namespace physpring {
namespace {

class ControlLatency : public SceneEffect {
 public:
  std::string name() const override { return "control_latency"; }
  std::vector<EffectKey> keys() const override {
    return {{"latency_s", 0, 2, true, "mocap bodies move so much later than recorded"}};
  }
  double Latency(const EffectAmounts& amounts) const override { return amounts.At("latency_s"); }
  EffectAmounts Trial(const EffectTrial& trial) const override {
    EffectAmounts amounts;
    amounts.Set("latency_s", 0.06 * trial.size);
    return amounts;
  }
};

}  // namespace

std::unique_ptr<SceneEffect> MakeSceneControlLatency() {
  return std::make_unique<ControlLatency>();
}

}  // namespace physpring
