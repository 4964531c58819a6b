// SPDX-License-Identifier: Apache-2.0
// An extra mass on the body of one particle.
#include "rollout/effects/scene_effect.h"

namespace physpring {
namespace {

class MassDistribution : public SceneEffect {
 public:
  std::string name() const override { return "mass_distribution"; }
  std::vector<EffectKey> keys() const override {
    std::vector<EffectKey> keys = {{"mass_kg", 0, 100, true, "mass of the body next to the place"}};
    const EffectKey place = {"place", -100, 100, false, kPlaceHelp};
    for (const EffectKey& key : VectorKeys(place, "m")) keys.push_back(key);
    return keys;
  }
  bool ChangeMasses(const EffectAmounts& amounts, const SceneBody& body,
                    mjModel* model) const override {
    const int carrier = body.CarrierOf(PlaceIn(body, amounts));
    const double mass = model->body_mass[carrier] + amounts.At("mass_kg");
    // as large as before: MuJoCo's fluid forces take the size from mass and inertia
    Eigen::Map<Eigen::Vector3d>(model->body_inertia + 3 * carrier) *=
        mass / model->body_mass[carrier];
    model->body_mass[carrier] = mass;
    return true;
  }
  EffectAmounts Trial(const EffectTrial& trial) const override {
    EffectAmounts amounts;
    amounts.Set("mass_kg", 0.5 * trial.size * trial.mass);
    amounts.SetVector("place", "m", trial.node);
    return amounts;
  }
};

}  // namespace

std::unique_ptr<SceneEffect> MakeSceneMassDistribution() {
  return std::make_unique<MassDistribution>();
}

}  // namespace physpring
