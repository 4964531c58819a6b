// SPDX-License-Identifier: Apache-2.0
// Quadratic drag of the whole body: option density and MuJoCo's fluid forces.
#include <algorithm>
#include <set>

#include "rollout/effects/scene_effect.h"
#include "rollout/scene.h"

namespace physpring {
namespace {

class AirDrag : public SceneEffect {
 public:
  std::string name() const override { return "air_drag"; }
  std::vector<EffectKey> keys() const override {
    std::vector<EffectKey> keys = {
        {"drag_kg_per_m", 0, 100, true,
         "quadratic drag of the whole body: option density, MuJoCo's fluid forces"}};
    const EffectKey wind = {"wind", -30, 30, false, "velocity of the air: option wind"};
    for (const EffectKey& key : VectorKeys(wind, "m_per_s")) keys.push_back(key);
    return keys;
  }

  void Change(const EffectAmounts& amounts, const SceneBody& body, mjModel* model) const override {
    const double force = ForceOfWind(body, model);
    model->opt.density += force > 0 ? amounts.At("drag_kg_per_m") / force : 0;
    Eigen::Map<Eigen::Vector3d>(model->opt.wind) += amounts.Vector("wind", "m_per_s");
  }

  EffectAmounts Trial(const EffectTrial& trial) const override {
    EffectAmounts amounts;
    amounts.Set("drag_kg_per_m", trial.drag);
    amounts.SetVector("wind", "m_per_s", 3 * trial.size * trial.sideways);
    return amounts;
  }

 private:
  // What a wind of 1 m/s does to the body in its reference configuration where the density is 1,
  // along the axis where that is largest, N.
  static double ForceOfWind(const SceneBody& body, mjModel* model) {
    const mjOption before = model->opt;
    const DataPtr data = MakeData(*model);
    const std::set<int>& bodies = body.Carriers();
    double most = 0;
    for (int axis = 0; axis < 3; ++axis) {
      model->opt.density = 1;
      model->opt.viscosity = 0;
      for (int i = 0; i < 3; ++i) model->opt.wind[i] = i == axis ? 1 : 0;
      mj_forward(model, data.get());
      double force = 0;
      for (int dof = 0; dof < model->nv; ++dof) {
        if (!bodies.contains(model->dof_bodyid[dof])) continue;
        force += data->qfrc_fluid[dof] * data->cdof[6 * dof + 3 + axis];
      }
      most = std::max(most, force);
    }
    model->opt = before;
    return most;
  }
};

}  // namespace

std::unique_ptr<SceneEffect> MakeSceneAirDrag() { return std::make_unique<AirDrag>(); }

}  // namespace physpring
