// SPDX-License-Identifier: Apache-2.0
// Springs that are longer or shorter at rest, linear along the body's longest axis.
#include "rollout/effects/scene_effect.h"

namespace physpring {
namespace {

class RestLength : public SceneEffect {
 public:
  std::string name() const override { return "rest_length"; }
  std::vector<EffectKey> keys() const override {
    return {
        {"strain_low_end", -0.8, 4, true,
         "of rest lengths at the low end of the body's longest axis, linear up to the other end"},
        {"strain_high_end", -0.8, 4, true, "at the other end"}};
  }
  void Edit(const EffectAmounts& amounts, const SceneBody& body, mjSpec* spec) const override {
    body.ForEachTendon(spec, [&](mjsTendon* tendon, int e) {
      const double strain = StrainAt(body.MiddleOf(e), amounts, body);
      for (int bound : {0, 1}) {
        const double before = tendon->springlength[bound] < 0
                                  ? body.plain().tendon_lengthspring[2 * e + bound]
                                  : tendon->springlength[bound];
        tendon->springlength[bound] = before * (1 + strain);
      }
    });
  }
  void Change(const EffectAmounts& amounts, const SceneBody& body, mjModel* model) const override {
    if (!body.of_flex()) return;
    const mjModel& plain = body.plain();
    for (int e = 0; e < plain.flex_edgenum[0]; ++e) {
      const int p = plain.flex_edge[2 * e], q = plain.flex_edge[2 * e + 1];
      const Eigen::Vector3d middle = (body.vertices().col(p) + body.vertices().col(q)) / 2;
      model->flexedge_length0[e] *= 1 + StrainAt(middle, amounts, body);
    }
  }
  EffectAmounts Trial(const EffectTrial& trial) const override {
    EffectAmounts amounts;
    amounts.Set("strain_low_end", -0.024 * trial.size);
    amounts.Set("strain_high_end", 0.056 * trial.size);
    return amounts;
  }

 private:
  static double StrainAt(const Eigen::Vector3d& place, const EffectAmounts& amounts,
                         const SceneBody& body) {
    Points all(3, body.reference().cols() + body.held().cols());
    all << body.reference(), body.held();
    const Eigen::Vector3d low = all.rowwise().minCoeff(), size = all.rowwise().maxCoeff() - low;
    Eigen::Index axis = 0;
    size.maxCoeff(&axis);
    const double s = (place[axis] - low[axis]) / size[axis];
    return (1 - s) * amounts.At("strain_low_end") + s * amounts.At("strain_high_end");
  }
};

}  // namespace

std::unique_ptr<SceneEffect> MakeSceneRestLength() { return std::make_unique<RestLength>(); }

}  // namespace physpring
