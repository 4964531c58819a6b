// SPDX-License-Identifier: Apache-2.0
// The springs of a system with its effects along them, inside the simulator: between the kernel,
// which knows geometry, and the effects, which know tensions (spring_tension.h). The internal
// variables of an effect stand in the state in records of their own, eight to a record, in the
// order of the springs in the kernel.
#ifndef PHYSPRING_TWIN_EFFECTS_TENSION_STEP_H_
#define PHYSPRING_TWIN_EFFECTS_TENSION_STEP_H_

#include <memory>
#include <vector>

#include "twin/effects/spring_tension.h"
#include "twin/kernel.h"
#include "twin/system_gradient.h"

namespace physpring {

// The internal variables in the records of a state from `record` on, as one array.
inline constexpr int kRecordSize = 8;
static_assert(sizeof(NodeState<float>) == kRecordSize * sizeof(float));
static_assert(sizeof(NodeState<double>) == kRecordSize * sizeof(double));
template <class Real>
Real* Internal(NodeStates<Real>* state, int record) {
  return reinterpret_cast<Real*>(state->data() + record);
}
template <class Real>
const Real* Internal(const NodeStates<Real>& state, int record) {
  return reinterpret_cast<const Real*>(state.data() + record);
}

// A sub-step in which effects act, and what computes its springs.
template <class Real>
struct EffectSubstep {
  const Kernel<Real>& kernel;
  SpringView<Real> springs;
  double time;  // s since the start of the recording
  double step;  // its length, s
  const NodeStates<Real>& state;
  const Points& controller_velocity;  // 3 x controllers, m/s
  const ControllerMask& released;     // hold nothing
};

// What sub-steps work in, and the sums of a frame's adjoint.
template <class Real>
struct TensionBuffers {
  std::vector<Real> length, rate, pull, tension;                  // (springs)
  std::vector<Real> tension_bar, length_bar, rate_bar, pull_bar;  // (springs)
  Points controller_velocity_bar;             // 3 x controllers, summed over sub-steps
  std::vector<std::vector<Real>> values_bar;  // one for each effect, see TensionGradient
};

template <class Real>
class TensionStep {
 public:
  using State = NodeStates<Real>;

  // `springs`: those of the system in the kernel's order, fillings included; their ends are read
  // here, and only here. The internal variables begin at the record `first_record` of a state.
  TensionStep(const SpringMassSystem& system, const SpringView<Real>& springs, int first_record);

  // The record of a state behind the internal variables.
  int end_record() const { return end_record_; }

  // A sub-step in parts, for rollouts whose springs are measured side by side. Effects add no
  // tension where there are none `along` springs; some need the places of nodes and controllers.
  bool along() const { return !tensions_.empty(); }
  bool needs_nodes() const { return !pulled_.empty(); }
  // Where length and rate of the springs are written to, before AddTensions is called.
  SpringMeasures<Real> Measures(TensionBuffers<Real>* buffers) const;
  // The tension of each spring. Gives `next` the internal variables.
  const Real* AddTensions(const EffectSubstep<Real>& now, State* next,
                          TensionBuffers<Real>* buffers) const;

  // Adds the forces of the springs at `now`, and gives `next` the internal variables.
  void AddForces(const EffectSubstep<Real>& now, State* next, NodeForces<Real>* force,
                 TensionBuffers<Real>* buffers) const;

  void ClearGradient(TensionBuffers<Real>* buffers) const;
  // Adjoint of AddForces, given force_bar: internal variables of state_bar in d loss / d those
  // after, out before.
  void AddForcesAdjoint(const EffectSubstep<Real>& now, const NodeForces<Real>& force_bar,
                        State* state_bar, SpringGradientView<Real> gradient,
                        TensionBuffers<Real>* buffers) const;
  // Adds the sums of a frame to the effects of `gradient`.
  void AddGradient(const TensionBuffers<Real>& buffers, SystemGradient* gradient) const;

 private:
  struct Tension {
    std::size_t effect;  // which of the system's
    Eigen::Index values;
    std::unique_ptr<const SpringTension> law;
    int record;  // where its internal variables begin
  };

  // A spring that joins a controller to a node.
  struct Pulled {
    int spring, controller, node;
  };

  SpringMoments<Real> Moments(const EffectSubstep<Real>& now, TensionBuffers<Real>* buffers) const;

  void MeasurePull(const EffectSubstep<Real>& now, TensionBuffers<Real>* buffers) const;
  void MeasurePullAdjoint(const EffectSubstep<Real>& now, State* state_bar,
                          TensionBuffers<Real>* buffers) const;

  int nodes_, controllers_;
  int springs_, end_record_;
  std::vector<Pulled> pulled_;  // none unless one of the laws feels them
  std::vector<Tension> tensions_;
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_EFFECTS_TENSION_STEP_H_
