// SPDX-License-Identifier: Apache-2.0
// Springs that are slack when compressed: MuJoCo's springlength with a range.
#include "rollout/effects/scene_effect.h"

namespace physpring {
namespace {

class TensionOnly : public SceneEffect {
 public:
  std::string name() const override { return "tension_only"; }
  std::vector<EffectKey> keys() const override {
    return {{kSlackShare, 0, 1, true, "1: springlength of tendons is \"0 L\"; or 0"}};
  }
  std::string WhyNot(const std::string&, const EffectAmounts& amounts,
                     const SceneBody& body) const override {
    if (body.of_flex()) return "its body is not made of tendons";
    const double share = amounts.At(kSlackShare, 1);
    return share == 0 || share == 1 ? "" : "MuJoCo's springs are slack wholly, 1, or not";
  }
  void Edit(const EffectAmounts&, const SceneBody& body, mjSpec* spec) const override {
    body.ForEachTendon(spec, [&](mjsTendon* tendon, int e) {
      tendon->springlength[0] = 0;
      tendon->springlength[1] = body.plain().tendon_lengthspring[2 * e + 1];
    });
  }
  EffectAmounts Trial(const EffectTrial&) const override {
    EffectAmounts amounts;
    amounts.Set(kSlackShare, 1);
    return amounts;
  }

 private:
  static constexpr char kSlackShare[] = "slack_share";
};

}  // namespace

std::unique_ptr<SceneEffect> MakeSceneTensionOnly() { return std::make_unique<TensionOnly>(); }

}  // namespace physpring
