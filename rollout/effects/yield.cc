// SPDX-License-Identifier: Apache-2.0
// Springs that stay stretched: MuJoCo's springyield of tendons, stressyield of flexes.
#include "rollout/effects/scene_effect.h"

namespace physpring {
namespace {

class Yield : public SceneEffect {
 public:
  std::string name() const override { return "yield"; }
  std::vector<EffectKey> keys() const override {
    return {{"yield_strain", 0, 10, true, "springyield of tendons, yield strain of flexes"}};
  }
  std::string WhyNot(const std::string&, const EffectAmounts&,
                     const SceneBody& body) const override {
    const bool of_lines = body.of_flex() && body.plain().flex_dim[0] == 1;
    return of_lines ? "MuJoCo's flexes of lines do not yield" : "";
  }
  void Edit(const EffectAmounts& amounts, const SceneBody& body, mjSpec* spec) const override {
    const double strain = amounts.At("yield_strain");
    if (body.of_flex()) {
      mjs_asFlex(mjs_firstElement(spec, mjOBJ_FLEX))->stressyield[0] += strain;
      return;
    }
    body.ForEachTendon(spec, [&](mjsTendon* tendon, int e) {
      tendon->springyield += strain * body.plain().tendon_lengthspring[2 * e + 1];
    });
  }
  EffectAmounts Trial(const EffectTrial& trial) const override {
    EffectAmounts amounts;
    amounts.Set("yield_strain", 0.03 / trial.size);
    return amounts;
  }
};

}  // namespace

std::unique_ptr<SceneEffect> MakeSceneYield() { return std::make_unique<Yield>(); }

}  // namespace physpring
