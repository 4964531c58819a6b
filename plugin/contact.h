// SPDX-License-Identifier: Apache-2.0
// The plugin physpring.contact: the learned contact law for a level whose springs MuJoCo simulates
// (tendons or flexes). The velocities that the nodes would have after the step are those of the
// passive forces and gravity; the law makes v' of them, and the force that brings v' about is
// added. physpring.springs has contacts of its own, inside its sub-steps.
#ifndef PHYSPRING_PLUGIN_CONTACT_H_
#define PHYSPRING_PLUGIN_CONTACT_H_

#include <mujoco/mujoco.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "plugin/level.h"
#include "plugin/mocap_motion.h"
#include "plugin/surfaces.h"
#include "twin/contact.h"

namespace physpring {

// What does not change: read from the attributes once, shared by copies of an mjData.
struct LevelContactModel {
  Level level;
  Contact<double> particles;  // contacts of the level's nodes with each other

  // Throws Error, one line that names instance, attribute and value.
  LevelContactModel(const mjModel* model, int instance);
};

class LevelContact {
 public:
  static constexpr const char* kName = "physpring.contact";
  static const std::vector<const char*>& AttributeNames();

  LevelContact(const mjModel* model, int instance);

  static int StateSize(const mjModel* model, int) { return MocapMotion(model).state_size(); }

  void Reset(int size, double* state) const { std::fill_n(state, size, 0); }
  void Compute(const mjModel* model, mjData* data, int instance);
  void Advance(const mjModel* model, mjData* data, int instance) {
    surfaces_.KeepPoses(data, data->plugin_state + model->plugin_stateadr[instance]);
  }

  // Those of the step that was computed last.
  const Surfaces& surfaces() const { return surfaces_; }

 private:
  std::shared_ptr<const LevelContactModel> contact_;
  Surfaces surfaces_;

  // Buffers of a step: the nodes before it, with the velocities after it in `next_`.
  NodeStates<double> state_, next_;
  Contact<double>::Impacts impacts_;
};

}  // namespace physpring

#endif  // PHYSPRING_PLUGIN_CONTACT_H_
