// SPDX-License-Identifier: Apache-2.0
// Friction along the springs: MuJoCo's frictionloss of tendons.
#include "rollout/effects/scene_effect.h"

namespace physpring {
namespace {

class DryFriction : public SceneEffect {
 public:
  std::string name() const override { return "dry_friction"; }
  std::vector<EffectKey> keys() const override {
    return {{"force_n", 0, 1e3, true, "frictionloss of tendons; on flexes along each edge"},
            {kSlipStrain, 0, 1, true, "frictionloss k L slip_strain of tendons"}};
  }
  std::string WhyNot(const std::string& key, const EffectAmounts&,
                     const SceneBody& body) const override {
    return body.of_flex() && key == kSlipStrain ? "its body is not made of tendons" : "";
  }
  void Edit(const EffectAmounts& amounts, const SceneBody& body, mjSpec* spec) const override {
    const double force = amounts.At("force_n"), strain = amounts.At(kSlipStrain);
    body.ForEachEdgeTendon(spec, [&](mjsTendon* tendon) { tendon->frictionloss = force; });
    body.ForEachTendon(spec, [&](mjsTendon* tendon, int e) {
      const mjModel& plain = body.plain();
      const double k = plain.tendon_stiffness[e], length = plain.tendon_lengthspring[2 * e + 1];
      tendon->frictionloss += force;
      tendon->frictionloss += strain * k * length;
    });
  }
  EffectAmounts Trial(const EffectTrial& trial) const override {
    EffectAmounts amounts;
    amounts.Set(kSlipStrain, 0.01 * trial.size);
    return amounts;
  }

 private:
  static constexpr char kSlipStrain[] = "slip_strain";
};

}  // namespace

std::unique_ptr<SceneEffect> MakeSceneDryFriction() { return std::make_unique<DryFriction>(); }

}  // namespace physpring
