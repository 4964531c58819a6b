// SPDX-License-Identifier: Apache-2.0
// One sub-step of a level and its adjoint. The trainer's simulator and the MuJoCo plugin both take
// it, so that they agree by construction. It is semi-implicit Euler:
//   F   springs, dashpots and effects at (x, v)          effects/effect_step.h
//   F <- its mean, where dashpots take several stages    dashpot_stages.h
//   v*  = (v + h (F / m + g)) exp(-h drag)               node_update.h
//   v'  = contacts(v*), then the owner's own contacts    contact.h
//   x'  = x + h v'                                       node_update.h
// Where the controllers are is the owner's to say, before each sub-step.
#ifndef PHYSPRING_TWIN_LEVEL_STEP_H_
#define PHYSPRING_TWIN_LEVEL_STEP_H_

#include <algorithm>
#include <memory>
#include <vector>

#include "twin/contact.h"
#include "twin/controller_mask.h"
#include "twin/dashpot_stages.h"
#include "twin/effects/effect_step.h"
#include "twin/kernel_choice.h"
#include "twin/node_state.h"
#include "twin/spring_blocks.h"
#include "twin/spring_mass_system.h"
#include "twin/system_gradient.h"

namespace physpring {

// What a sub-step of one length needs to know of the nodes.
template <class Real>
class NodeStep {
 public:
  // h: s; gravity: m/s^2.
  void Set(const SpringMassSystem& system, double h, const Eigen::Vector3d& gravity);
  NodeView<Real> View() const {
    return {static_cast<int>(h_over_mass_.size()), h_over_mass_.data(), h_, decay_, kick_};
  }

 private:
  std::vector<Real> h_over_mass_;
  Real h_ = 0, decay_ = 1;
  NodeForce<Real> kick_{};
};

// When a sub-step is, and what acts in it from outside.
template <class Real>
struct LevelSubstep {
  NodeView<Real> nodes;
  double start;                                // the frame's start, s since that of the recording
  double elapsed;                              // since the start of the frame, s
  double h;                                    // its length, s
  const Points& controller_velocity;           // 3 x controllers, m/s
  const typename Contact<Real>::Pairs& pairs;  // the particles that may collide
  const std::vector<Geom>& geoms;
};

// What sub-steps work in, and the sums over a frame of its adjoint.
template <class Real>
struct LevelBuffers {
  explicit LevelBuffers(const SpringBlocks<Real>& springs)
      : force(springs.spare_node + 1), spring_gradient(springs.size()) {}

  NodeForces<Real> force;
  EffectBuffers<Real> effects;
  DashpotBuffers<Real> dashpots;
  SpringBlockGradient<Real> spring_gradient;
  NodeForces<Real> mass_gradient;  // this, drag and gravity: see node_update.h
  NodeForce<Real> drag_gradient, gravity_gradient;
  ContactGradient<Real> contact_gradient;
};

template <class Real>
class LevelStep {
 public:
  using State = NodeStates<Real>;
  using Impacts = typename Contact<Real>::Impacts;

  LevelStep(const SpringMassSystem& system, const Environment& environment,
            const Kernel<Real>& kernel);

  // The parameters, masses, drag and effects of a system of the same topology and effects.
  void SetParameters(const SpringMassSystem& system);

  // Changes one of springs(): it is longer at rest by `shift`, but at least `shortest`, m, or it
  // pulls at nothing. SetParameters undoes it.
  void ShiftRestLength(int slot, Real shift, Real shortest) {
    springs_.rest_length[slot] = std::max(springs_.rest_length[slot] + shift, shortest);
  }
  void OpenSpring(int slot) { springs_.stiffness[slot] = springs_.dashpot[slot] = 0; }
  // Effects no longer act on these controllers.
  void Release(const ControllerMask& released) { released_ = released; }

  const SpringBlocks<Real>& springs() const { return springs_; }
  const Contact<Real>& contact() const { return contact_; }
  const EffectStep<Real>& effects() const { return *effects_; }
  const DashpotStages<Real>& dashpot_stages() const { return dashpot_stages_; }
  // The record of a state from which on the effects' internal variables stand, and that behind.
  int first_internal() const { return springs_.spare_node + 1; }
  int state_size() const { return first_internal() + effects_->extra_records(); }

  // Sets the nodes and internal variables of `next`; its controllers are left alone. After the
  // level's contacts, other_contacts(next) may change the velocities.
  template <class OtherContacts>
  void Advance(const LevelSubstep<Real>& now, const State& state, State* next, Impacts* impacts,
               LevelBuffers<Real>* buffers, const OtherContacts& other_contacts) const {
    AddForces(now, state, next, buffers);
    kernel_->update_velocities(now.nodes, state.data(), buffers->force.data(), next->data());
    contact_.Apply(state, now.pairs, now.geoms, now.elapsed, now.h, next, impacts);
    other_contacts(next);
    kernel_->update_positions(now.nodes, state.data(), next->data());
  }

  // Before the adjoints of a frame's sub-steps.
  void ClearGradient(LevelBuffers<Real>* buffers) const;
  // Adjoint of Advance without other contacts. state_bar: in d loss / d next, out d loss / d state.
  // The velocities of `next` become those before the contacts.
  void AdvanceAdjoint(const LevelSubstep<Real>& now, const State& state, State* next,
                      Impacts* impacts, State* state_bar, LevelBuffers<Real>* buffers) const;
  // Adds the sums of a frame of sub-steps of h seconds, with respect to the system as its effects
  // change it; EffectStep::FinishGradient makes of them those with respect to the system.
  void AddGradients(const NodeView<Real>& nodes, double h, const LevelBuffers<Real>& buffers,
                    SystemGradient* gradient) const;

  // What its effects see of a sub-step.
  EffectSubstep<Real> EffectsOf(const LevelSubstep<Real>& now, const State& state) const {
    return {*kernel_, springs_.View(), now.start + now.elapsed,
            now.h,    state,           now.controller_velocity,
            released_};
  }

 private:
  // Sets buffers->force, and the internal variables of `next`.
  void AddForces(const LevelSubstep<Real>& now, const State& state, State* next,
                 LevelBuffers<Real>* buffers) const;
  void RepeatForces(const LevelSubstep<Real>& now, const State& state,
                    LevelBuffers<Real>* buffers) const;

  const Kernel<Real>* kernel_;
  SpringBlocks<Real> springs_;
  DashpotStages<Real> dashpot_stages_;
  Contact<Real> contact_;
  Eigen::Vector3d gravity_;  // the environment's, m/s^2
  ControllerMask released_;
  std::shared_ptr<const EffectStep<Real>> effects_;  // never null; of no effects, it adds nothing
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_LEVEL_STEP_H_
