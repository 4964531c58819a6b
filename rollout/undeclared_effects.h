// SPDX-License-Identifier: Apache-2.0
// Effects that a scene has and its recording does not tell of, for trying a diagnosis on. All are
// MuJoCo's own (tendons, flexes, bodies and options), or forces from outside; none of a twin's
// effects is used. Names and units: effect_keys.h.
//
// What depends on time begins at time 0, the recording's first frame. Attraction: a particle of
// mass m of a body of mass M, at the distance d from the moving point, feels
//   F = strength m / M  d / (|d|^2 + 0.03^2)^(3/2)
#ifndef PHYSPRING_ROLLOUT_UNDECLARED_EFFECTS_H_
#define PHYSPRING_ROLLOUT_UNDECLARED_EFFECTS_H_

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "rollout/effect_keys.h"
#include "rollout/soft_points.h"

namespace physpring {

class UndeclaredEffects {
 public:
  // `plain` is the scene without the effects, `soft` its soft body; both must outlive this. Throws
  // Error, one line that begins with `where`, if the scene cannot have an effect; it lists those
  // that it can have.
  UndeclaredEffects(const SceneEffects& effects, const mjModel& plain, const SoftPoints& soft,
                    const std::string& where);

  bool empty() const { return values_.empty(); }

  // Before the scene with effects is compiled: its tendons and flex, and new tendons.
  void Edit(mjSpec* spec) const;

  // After it: options, masses, friction, a flex's rest lengths.
  void Change(mjModel* model) const;

  // What changes in time, before the step that begins at `time` [s].
  void Drive(double time, mjModel* model, mjData* data) const;

  // How much later than recorded the mocap bodies move, s.
  double latency() const { return Value("control_latency.latency_s"); }

 private:
  bool Has(const std::string& effect) const;  // with an amount other than 0
  double Value(const std::string& key, double otherwise = 0) const;
  Eigen::Vector3d Vector(const std::string& key, const std::string& unit,
                         const Eigen::Vector3d& otherwise) const;
  std::string WhyNot(const EffectKey& key) const;  // the scene cannot have it; empty if it can

  int Place(const std::string& effect) const;  // the particle next to it, of `particles_`
  double RestStrain(const Eigen::Vector3d& place) const;
  double AirDensity(mjModel* model) const;
  void EditTendons(mjSpec* spec) const;
  void AddEdgeTendons(mjSpec* spec) const;
  void AddTether(mjSpec* spec) const;
  std::string SiteOn(int element, mjSpec* spec) const;  // its name; makes one on a flex's vertex
  void ChangeMass(mjModel* model) const;
  void ChangeFriction(mjModel* model) const;
  void ChangeFlexLengths(mjModel* model) const;
  void DriveForces(double time, mjModel* model, mjData* data) const;

  SceneEffects values_;  // only those of effects that are there
  const mjModel& plain_;
  const SoftPoints& soft_;
  std::vector<int> particles_;  // elements, points before interior
  Points reference_, held_;     // particles and controllers in the reference configuration, m
  Points vertices_, sites_;     // all of the model, there, m
};

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_UNDECLARED_EFFECTS_H_
