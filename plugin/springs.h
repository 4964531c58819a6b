// SPDX-License-Identifier: Apache-2.0
// The plugin physpring.springs: springs, dashpots, drag, effects and contacts of one level,
// integrated with sub-steps of its own inside MuJoCo's step: those of the trainer
// (twin/level_step.h).
//
// A step of length H has n sub-steps of h = H / n. MuJoCo knows one velocity a node and step: the
// force is the one that gives the node the mean velocity of the sub-steps, v_mean, so that it lands
// where they end. That velocity v_end differs from v_mean; the difference is the state:
//   compute   v = qvel + lag,  n sub-steps,  f: qvel' = v_mean
//   advance   lag = v_end - v_mean
// With n = 1 the lag is 0. Velocities that other forces and constraints add to qvel are carried
// over. Mocap controllers move linearly from where they were in the step before, and have that
// velocity; moving ones move on with theirs and feel the springs' mean force.
//
// Controllers may let go and take hold: plugin_state begins with a number for each of them that the
// user sets, 0 = it holds. After a reset it is what the attribute `released` says. One that takes
// hold again takes the level as it is then (twin/grasp_springs.h).
#ifndef PHYSPRING_PLUGIN_SPRINGS_H_
#define PHYSPRING_PLUGIN_SPRINGS_H_

#include <mujoco/mujoco.h>

#include <memory>
#include <optional>
#include <vector>

#include "plugin/euler_step.h"
#include "plugin/level.h"
#include "plugin/surfaces.h"
#include "twin/grasp_springs.h"
#include "twin/level_step.h"
#include "twin/plugin_state.h"

namespace physpring {

// What does not change: read from the attributes once, shared by copies of an mjData.
struct SpringsModel {
  Level level;
  bool controller_velocity;
  ControllerMask released;  // at first
  double substep;           // s, the longest
  LevelStep<double> step;   // contacts are those of the level's nodes with each other
  GraspSprings<double> grasps;

  // Throws Error, one line that names instance, attribute and value.
  SpringsModel(const mjModel* model, int instance);

  int state_size() const { return step.state_size() + grasps.records(); }
  // How many numbers are the effects' internal variables and the shifts of grasps.
  int internal_size() const { return kRecordSize * (state_size() - step.first_internal()); }
};

class Springs {
 public:
  static constexpr const char* kName = "physpring.springs";
  static const std::vector<const char*>& AttributeNames();

  Springs(const mjModel* model, int instance);
  Springs(const Springs& other) = default;

  // The size of plugin_state, and what it is at first.
  static int StateSize(const mjModel* model, int instance);

  void Reset(int size, double* state) const;
  void Compute(const mjModel* model, mjData* data, int instance);
  void Advance(const mjModel* model, mjData* data, int instance);

  // Those of the step that was computed last.
  const Surfaces& surfaces() const { return surfaces_; }
  // Calls function(body, impulse) for each controller: what the springs gave it in that step, N s.
  template <class Function>
  void ForEachPull(Function function) const {
    for (std::size_t c = 0; c < ways_.size(); ++c) {
      function(springs_->level.bodies.controllers[c], ways_[c].impulse);
    }
  }

 private:
  // A controller's way through the step.
  struct Way {
    Eigen::Vector3d from, velocity;
    Eigen::Vector3d impulse = Eigen::Vector3d::Zero();
    bool is_mocap;
  };

  PluginState StateOf(const mjModel* model, mjData* data, int instance) const {
    return PluginState(data->plugin_state + model->plugin_stateadr[instance], nodes(),
                       static_cast<int>(ways_.size()), surfaces_.state_size());
  }

  int nodes() const { return springs_->level.system.node_count(); }
  void ReadNodes(const EulerStep& step, const mjData* data, const double* lag);
  void ReadControllers(const mjModel* model, const mjData* data, double time, const double* before);
  void ReadInternal(const double* internal);
  void TakeHold(const ControllerMask& attached);
  void ReadGrasps(const PluginState& plugin_state);
  // That of the step of MuJoCo which is computed.
  const LevelStep<double>& step() const { return own_step_ ? *own_step_ : springs_->step; }
  bool IsFinite() const;
  void PlaceControllers(double elapsed, double h);
  void Substep(double time, double elapsed, double h, const Contact<double>::Pairs& pairs);
  void WriteForces(const mjModel* model, const EulerStep& step, int substeps, mjData* data);

  std::shared_ptr<const SpringsModel> springs_;
  Surfaces surfaces_;

  // Of the grasps as they are, where they were ever changed.
  std::optional<LevelStep<double>> own_step_;
  ControllerMask released_;
  Eigen::VectorXd rest_length_;  // (springs), m

  // Buffers of a step. `lag_` is for the Advance of the same step.
  NodeStep<double> node_step_;
  NodeStates<double> state_, next_;
  LevelBuffers<double> buffers_;
  Contact<double>::Impacts impacts_;
  std::vector<Way> ways_;
  Points controller_velocity_;  // 3 x controllers, m/s
  std::vector<double> lag_;
  bool is_computed_ = false;
};

}  // namespace physpring

#endif  // PHYSPRING_PLUGIN_SPRINGS_H_
