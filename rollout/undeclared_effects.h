// SPDX-License-Identifier: Apache-2.0
// Effects that a scene has and its recording does not tell of, for trying a diagnosis on. What each
// does to the scene is in its file in rollout/effects/; here they act together.
#ifndef PHYSPRING_ROLLOUT_UNDECLARED_EFFECTS_H_
#define PHYSPRING_ROLLOUT_UNDECLARED_EFFECTS_H_

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "rollout/effect_keys.h"
#include "rollout/effects/scene_body.h"
#include "rollout/effects/scene_effect.h"

namespace physpring {

class UndeclaredEffects {
 public:
  // `plain` is the scene without the effects, `soft` its soft body; both must outlive this. Throws
  // Error, one line that begins with `where`, if the scene cannot have an effect; it lists those
  // that it can have.
  UndeclaredEffects(const SceneEffects& effects, const mjModel& plain, const SoftPoints& soft,
                    const std::string& where);

  bool empty() const { return given_.empty(); }

  // Before the scene with effects is compiled: its tendons and flex, and new tendons.
  void Edit(mjSpec* spec) const;

  // After it: options, masses, friction, a flex's rest lengths.
  void Change(mjModel* model) const;

  // What changes in time, before the step that begins at `time` [s].
  void Drive(double time, mjModel* model, mjData* data) const;

  // How much later than recorded the mocap bodies move, s.
  double latency() const;

 private:
  struct Given {
    const SceneEffect* effect;
    EffectAmounts amounts;

    bool has_amount() const;  // other than 0
  };

  // Throws Error if the body cannot have one of the effects.
  void ExpectPossible(const std::string& where) const;

  SceneBody body_;
  std::vector<Given> given_;  // only those that are there
};

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_UNDECLARED_EFFECTS_H_
