// SPDX-License-Identifier: Apache-2.0
// A tendon of length 0 from a particle to a point of the world.
#include "rollout/effects/scene_effect.h"

namespace physpring {
namespace {

constexpr char kAnchorName[] = "undeclared anchor";

class Tether : public SceneEffect {
 public:
  std::string name() const override { return "tether"; }
  std::vector<EffectKey> keys() const override {
    std::vector<EffectKey> keys = {
        {"stiffness_n_per_m", 0, 1e4, true, "a tendon of length 0 from the place to a world point"},
        {"damping_n_s_per_m", 0, 100, false, "of that tendon, along it; default: 0"}};
    const EffectKey place = {"place", -100, 100, false, kPlaceHelp};
    const EffectKey anchor = {"anchor", -100, 100, false, "the world point; default: the place"};
    for (const EffectKey& stem : {place, anchor}) {
      for (const EffectKey& key : VectorKeys(stem, "m")) keys.push_back(key);
    }
    return keys;
  }
  void Edit(const EffectAmounts& amounts, const SceneBody& body, mjSpec* spec) const override {
    const int place = PlaceIn(body, amounts);
    mjsSite* anchor = mjs_addSite(mjs_findBody(spec, "world"), nullptr);
    mjs_setName(anchor->element, kAnchorName);
    Eigen::Map<Eigen::Vector3d>(anchor->pos) =
        amounts.Vector("anchor", "m", body.reference().col(place));
    mjsTendon* tendon = AddTendon(spec, "tether", body.SiteOn(place, spec), kAnchorName);
    tendon->stiffness[0] = amounts.At("stiffness_n_per_m");
    tendon->damping[0] = amounts.At("damping_n_s_per_m");
    tendon->springlength[0] = tendon->springlength[1] = 0;
  }
  EffectAmounts Trial(const EffectTrial& trial) const override {
    EffectAmounts amounts;
    amounts.Set("stiffness_n_per_m", 2 * trial.size);
    amounts.SetVector("place", "m", trial.node);
    amounts.SetVector("anchor", "m", trial.node + 0.1 * trial.sideways);
    return amounts;
  }
};

}  // namespace

std::unique_ptr<SceneEffect> MakeSceneTether() { return std::make_unique<Tether>(); }

}  // namespace physpring
