// SPDX-License-Identifier: Apache-2.0
// Attraction to a point that circles. A particle of mass m of a body of mass M, at the distance d
// from the point, feels F = strength m / M  d / (|d|^2 + 0.03^2)^(3/2). A twin has no such effect:
// a diagnosis is tried on it for what is beyond its list.
#include <cmath>

#include "rollout/effects/scene_effect.h"

namespace physpring {
namespace {

constexpr double kCore = 0.03;                                   // m, of the attraction
constexpr double kCircle = 0.12, kCircleRate = 8, kBelow = 0.1;  // its way: m, rad/s, m

class MovingAttraction : public SceneEffect {
 public:
  std::string name() const override { return "moving_attraction"; }
  std::vector<EffectKey> keys() const override {
    std::vector<EffectKey> keys = {
        {"strength_n_m2", -10, 10, true,
         "attraction of the whole body, strength / r^2, to a point that circles: xfrc_applied"},
        {"radius_m", 0, 10, false, "of its horizontal circle; default: 0.12"},
        {"rate_rad_per_s", -100, 100, false, "at which it goes round; default: 8"}};
    const EffectKey centre = {"centre", -100, 100, false,
                              "middle of its way; default: 0.1 m below the body"};
    for (const EffectKey& key : VectorKeys(centre, "m")) keys.push_back(key);
    return keys;
  }
  void AddForces(const EffectAmounts& amounts, const SceneBody& body, double time,
                 const mjModel& model, mjData* data) const override {
    mj_kinematics(&model, data);
    const Eigen::Vector3d middle =
        body.reference().rowwise().mean() - kBelow * Eigen::Vector3d::UnitZ();
    const double angle = amounts.At("rate_rad_per_s", kCircleRate) * time;
    const Eigen::Vector3d point =
        amounts.Vector("centre", "m", middle) +
        amounts.At("radius_m", kCircle) * Eigen::Vector3d(std::sin(angle), std::cos(angle), 0);
    AddToBodies(body, model, data, [&](int carrier) -> Eigen::Vector3d {
      const Eigen::Vector3d away =
          point - Eigen::Map<const Eigen::Vector3d>(data->xipos + 3 * carrier);
      const double pull =
          amounts.At("strength_n_m2") / std::pow(away.squaredNorm() + kCore * kCore, 1.5);
      return pull * away;
    });
  }
  EffectAmounts Trial(const EffectTrial& trial) const override {
    EffectAmounts amounts;
    amounts.Set("strength_n_m2", 4e-5 * trial.size * static_cast<double>(trial.nodes));
    amounts.SetVector("centre", "m", trial.beside);
    return amounts;
  }
};

}  // namespace

std::unique_ptr<SceneEffect> MakeSceneMovingAttraction() {
  return std::make_unique<MovingAttraction>();
}

}  // namespace physpring
