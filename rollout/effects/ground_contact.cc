// SPDX-License-Identifier: Apache-2.0
// Friction with the ground other than the scene's. MuJoCo takes the larger friction of the two in
// contact, or that of the higher priority: both get the new one.
#include <algorithm>
#include <set>

#include "rollout/effects/scene_effect.h"

namespace physpring {
namespace {

class GroundContact : public SceneEffect {
 public:
  std::string name() const override { return "ground_contact"; }
  std::vector<EffectKey> keys() const override {
    return {{"friction_change", -2, 2, true, "friction with the ground, added to its own"}};
  }
  std::string WhyNot(const std::string&, const EffectAmounts&,
                     const SceneBody& body) const override {
    return body.Grounds().empty() ? "it has no ground" : "";
  }
  void Change(const EffectAmounts& amounts, const SceneBody& body, mjModel* model) const override {
    const std::vector<mjtNum*> parts = FrictionOf(body, model);
    for (const int ground : body.Grounds()) {
      double friction = body.plain().geom_friction[3 * ground];
      for (const mjtNum* part : parts) friction = std::max(friction, *part);
      friction = std::max(0.0, friction + amounts.At("friction_change"));
      for (mjtNum* part : parts) *part = friction;
      model->geom_friction[3 * ground] = friction;
    }
  }

 private:
  // The sliding friction of the body's flex or geoms.
  static std::vector<mjtNum*> FrictionOf(const SceneBody& body, mjModel* model) {
    if (body.of_flex()) return {model->flex_friction};
    const std::set<int>& carriers = body.Carriers();
    std::vector<mjtNum*> parts;
    for (int geom = 0; geom < model->ngeom; ++geom) {
      if (carriers.contains(model->geom_bodyid[geom])) {
        parts.push_back(model->geom_friction + 3 * geom);
      }
    }
    return parts;
  }
};

}  // namespace

std::unique_ptr<SceneEffect> MakeSceneGroundContact() { return std::make_unique<GroundContact>(); }

}  // namespace physpring
