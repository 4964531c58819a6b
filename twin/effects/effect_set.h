// SPDX-License-Identifier: Apache-2.0
// All effects of a system together, bound to it: what they change and their forces on nodes.
#ifndef PHYSPRING_TWIN_EFFECTS_EFFECT_SET_H_
#define PHYSPRING_TWIN_EFFECTS_EFFECT_SET_H_

#include <memory>
#include <vector>

#include "twin/effects/bend_effect.h"
#include "twin/effects/effect.h"

namespace physpring {

// The system and gravity as its effects change them, one after the other.
Setting ApplyEffects(const SpringMassSystem& system, const Eigen::Vector3d& gravity);

// How much later than recorded the controllers of the system move, s.
double ControllerDelay(const SpringMassSystem& system);

// A system without effects whose stable sub-steps are stable for `system` with its effects.
SpringMassSystem BoundingSystem(const SpringMassSystem& system);

class EffectSet {
 public:
  EffectSet(const SpringMassSystem& system, const Eigen::Vector3d& gravity);
  EffectSet(const EffectSet&) = delete;
  EffectSet& operator=(const EffectSet&) = delete;

  const Setting& changed() const { return settings_.back(); }
  int internal_size() const { return offset_.back(); }

  // Whether there are any on nodes.
  bool has_forces() const;
  // Forces of all effects on nodes of the changed system; see EffectForce.
  void AddForces(const Instant& instant, Eigen::VectorXd* internal, Points* force) const;
  // Adds d loss / d state to x_bar and v_bar, and to the effects of `gradient`, which is with
  // respect to the changed system.
  void AddForcesAdjoint(const Instant& instant, const Eigen::VectorXd& internal,
                        const Points& force_bar, Eigen::VectorXd* internal_bar, Points* x_bar,
                        Points* v_bar, SystemGradient* gradient) const;

  // Turns a gradient with respect to the changed system into one with respect to the system.
  // `delay_bar`: d loss / d ControllerDelay.
  void ChangeAdjoint(double delay_bar, SystemGradient* gradient) const;

 private:
  std::vector<const Effect*> effects_;
  std::vector<Setting> settings_;  // before the first effect, between them, after the last
  // one for each effect; null: none
  std::vector<std::unique_ptr<EffectForce>> forces_;
  std::vector<std::unique_ptr<BendMoment>> bends_;
  std::vector<BendLaw> bend_laws_;  // those of bends_ that are there
  // where each effect's internal variables begin; the last one: their number
  std::vector<int> offset_;
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_EFFECTS_EFFECT_SET_H_
