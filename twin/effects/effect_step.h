// SPDX-License-Identifier: Apache-2.0
// The effects of a system inside the simulator. Those along the springs act with them
// (tension_step.h); those on nodes compute in double, whatever the precision of the states. Behind
// the spare node of a state stand the internal variables of the former, then of the latter, eight
// to a record.
#ifndef PHYSPRING_TWIN_EFFECTS_EFFECT_STEP_H_
#define PHYSPRING_TWIN_EFFECTS_EFFECT_STEP_H_

#include "twin/effects/effect_set.h"
#include "twin/effects/tension_step.h"

namespace physpring {

// What a frame's sub-steps work in, and the sums of its adjoint.
template <class Real>
struct EffectBuffers {
  TensionBuffers<Real> tension;
  Points x, v, force, x_bar, v_bar;
  Eigen::VectorXd internal, internal_bar;
  std::vector<SystemGradient> gradient;  // one, with respect to the changed system; none: cleared
  Points start_bar, end_bar;             // d loss / d the controllers of the frame
};

template <class Real>
class EffectStep {
 public:
  using State = NodeStates<Real>;

  // `springs`: see TensionStep.
  EffectStep(const SpringMassSystem& system, const Eigen::Vector3d& gravity,
             const SpringView<Real>& springs)
      : effects_(system, gravity),
        nodes_(system.node_count()),
        columns_(static_cast<int>(system.position.cols())),
        tensions_(system, springs, columns_ + 1) {}

  const Setting& changed() const { return effects_.changed(); }

  // Records of a state behind those of the system.
  int extra_records() const {
    return tensions_.end_record() - (columns_ + 1) +
           (effects_.internal_size() + kRecordSize - 1) / kRecordSize;
  }

  const TensionStep<Real>& tensions() const { return tensions_; }
  bool has_node_forces() const { return effects_.has_forces(); }
  // Sets buffers->force to the forces on nodes, 3 x columns, N. Gives `next` their internal
  // variables.
  void ComputeNodeForces(const EffectSubstep<Real>& now, State* next,
                         EffectBuffers<Real>* buffers) const;

  // Adds the forces of springs and effects at `now`, and gives `next` its internal variables.
  void AddForces(const EffectSubstep<Real>& now, State* next, NodeForces<Real>* force,
                 EffectBuffers<Real>* buffers) const;

  void ClearGradient(EffectBuffers<Real>* buffers) const;
  // Adjoint of AddForces, given force_bar: internal variables of state_bar in d loss / d those
  // after, out before.
  void AddForcesAdjoint(const EffectSubstep<Real>& now, const NodeForces<Real>& force_bar,
                        State* state_bar, SpringGradientView<Real> gradient,
                        EffectBuffers<Real>* buffers) const;
  // Takes what a sub-step added to the controllers' derivatives: they stood `fraction` of the way
  // from start to end, and moved with (end - start) / frame_time, or 0 if that is 0.
  void TakeControllers(double fraction, double frame_time, State* state_bar,
                       EffectBuffers<Real>* buffers) const;
  // Completes start_bar and end_bar after the sub-steps of a frame.
  void FinishControllers(double frame_time, EffectBuffers<Real>* buffers) const;
  // Adds the sums of a frame to `gradient`, which holds those with respect to the changed system
  // so far, and turns it into one with respect to the system and its effects. start_rate and
  // end_rate: see FrameInput.
  void FinishGradient(const Points& start_rate, const Points& end_rate,
                      const EffectBuffers<Real>& buffers, SystemGradient* gradient) const;

 private:
  void AddNodeForcesAdjoint(const EffectSubstep<Real>& now, const NodeForces<Real>& force_bar,
                            State* state_bar, EffectBuffers<Real>* buffers) const;
  void Unpack(const State& state, EffectBuffers<Real>* buffers) const;
  void UnpackInternal(const State& state, Eigen::VectorXd* internal) const;
  void PackInternal(const Eigen::VectorXd& internal, State* state) const;

  EffectSet effects_;
  int nodes_, columns_;
  TensionStep<Real> tensions_;
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_EFFECTS_EFFECT_STEP_H_
