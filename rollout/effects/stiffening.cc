// SPDX-License-Identifier: Apache-2.0
// Springs that grow stiffer as they stretch: MuJoCo's third stiffness coefficient of tendons.
#include "rollout/effects/scene_effect.h"

namespace physpring {
namespace {

class Stiffening : public SceneEffect {
 public:
  std::string name() const override { return "stiffening"; }
  std::vector<EffectKey> keys() const override {
    return {{"cubic_n_per_m3", 0, 1e9, true,
             "third stiffness coefficient of tendons; on flexes along each edge"},
            {kRatio, 0, 1e4, true, "third stiffness coefficient k ratio / L^2 of tendons"}};
  }
  std::string WhyNot(const std::string& key, const EffectAmounts&,
                     const SceneBody& body) const override {
    return body.of_flex() && key == kRatio ? "its body is not made of tendons" : "";
  }
  void Edit(const EffectAmounts& amounts, const SceneBody& body, mjSpec* spec) const override {
    const double cubic = amounts.At("cubic_n_per_m3"), ratio = amounts.At(kRatio);
    body.ForEachEdgeTendon(spec, [&](mjsTendon* tendon) { tendon->stiffness[2] = cubic; });
    body.ForEachTendon(spec, [&](mjsTendon* tendon, int e) {
      const mjModel& plain = body.plain();
      const double k = plain.tendon_stiffness[e], length = plain.tendon_lengthspring[2 * e + 1];
      tendon->stiffness[2] += cubic;
      tendon->stiffness[2] += ratio * k / (length * length);
    });
  }
  EffectAmounts Trial(const EffectTrial& trial) const override {
    EffectAmounts amounts;
    amounts.Set(kRatio, 60 * trial.size);
    return amounts;
  }

 private:
  static constexpr char kRatio[] = "cubic_stiffness_ratio";
};

}  // namespace

std::unique_ptr<SceneEffect> MakeSceneStiffening() { return std::make_unique<Stiffening>(); }

}  // namespace physpring
