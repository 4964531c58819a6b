// SPDX-License-Identifier: Apache-2.0
// The effects of a system inside the simulator: between its node states, of either precision, and
// the effects, which compute in double. Behind the spare node of a state stand the internal
// variables of the effects, six to a record.
#ifndef PHYSPRING_TWIN_EFFECTS_EFFECT_STEP_H_
#define PHYSPRING_TWIN_EFFECTS_EFFECT_STEP_H_

#include "twin/effects/effect_set.h"
#include "twin/node_state.h"

namespace physpring {

// What a frame's sub-steps work in, and the sums of its adjoint.
struct EffectBuffers {
  Points x, v, force, x_bar, v_bar;
  Eigen::VectorXd internal, internal_bar;
  std::vector<SystemGradient> gradient;  // one, with respect to the changed system; none: cleared
  Points start_bar, end_bar;             // d loss / d the controllers of the frame
};

template <class Real>
class EffectStep {
 public:
  using State = NodeStates<Real>;

  EffectStep(const SpringMassSystem& system, const Eigen::Vector3d& gravity)
      : effects_(system, gravity),
        nodes_(system.node_count()),
        columns_(static_cast<int>(system.position.cols())) {}

  const Setting& changed() const { return effects_.changed(); }

  // Records of a state behind those of the system.
  int extra_records() const { return (effects_.internal_size() + 5) / 6; }

  // Adds the forces at `state` and gives `next` its internal variables.
  void AddForces(double time, double step, const State& state, State* next, NodeForces<Real>* force,
                 EffectBuffers* buffers) const;

  void ClearGradient(EffectBuffers* buffers) const;
  // Adjoint of AddForces, given force_bar: internal variables of state_bar in d loss / d those
  // after, out before.
  void AddForcesAdjoint(double time, double step, const State& state,
                        const NodeForces<Real>& force_bar, State* state_bar,
                        EffectBuffers* buffers) const;
  // Takes what a sub-step added to the controllers' derivatives: they stood `fraction` of the way
  // from start to end, and moved with (end - start) / frame_time, or 0 if that is 0.
  void TakeControllers(double fraction, double frame_time, State* state_bar,
                       EffectBuffers* buffers) const;
  // Adds the sums of a frame to `gradient`, which holds those with respect to the changed system
  // so far, and turns it into one with respect to the system and its effects. start_rate and
  // end_rate: see FrameInput.
  void FinishGradient(const Points& start_rate, const Points& end_rate,
                      const EffectBuffers& buffers, SystemGradient* gradient) const;

 private:
  void Unpack(const State& state, EffectBuffers* buffers) const;

  EffectSet effects_;
  int nodes_, columns_;
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_EFFECTS_EFFECT_STEP_H_
