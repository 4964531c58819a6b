// SPDX-License-Identifier: Apache-2.0
#include "twin/lane_simulator.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "twin/stop_request.h"

namespace physpring {

bool AreAlike(const SpringMassSystem& a, const SpringMassSystem& b) {
  return a.position.cols() == b.position.cols() && a.controllers == b.controllers &&
         a.springs == b.springs && a.dashpot_stages == b.dashpot_stages &&
         a.contact.collision_distance == b.contact.collision_distance &&
         (a.contact.collision_distance == 0 || a.position == b.position) &&
         std::equal(a.effects.begin(), a.effects.end(), b.effects.begin(), b.effects.end(),
                    [](const EffectValues& p, const EffectValues& q) {
                      return p.name == q.name && p.values.size() == q.values.size();
                    });
}

template <class Real>
std::vector<Simulator<Real>> LaneSimulator<Real>::SimulatorsOf(
    const std::vector<SpringMassSystem>& systems, const Environment& environment,
    const SimulationOptions& options) {
  const Simulator<Real> first(systems[0], environment, options);
  std::vector<Simulator<Real>> simulators(systems.size(), first);
  for (std::size_t i = 1; i < systems.size(); ++i) simulators[i].SetParameters(systems[i]);
  return simulators;
}

template <class Real>
LaneStep<Real> LaneSimulator<Real>::StepOfFrame() const {
  std::vector<const LevelStep<Real>*> levels;
  std::vector<NodeView<Real>> nodes;
  for (std::size_t i = 0; i < simulators_.size(); ++i) {
    levels.push_back(&simulators_[i].StepOf(workspaces_[i]));
    nodes.push_back(simulators_[i].node_step_.View());
  }
  return LaneStep<Real>(levels, nodes, kernel_);
}

template <class Real>
LaneSimulator<Real>::LaneSimulator(const std::vector<SpringMassSystem>& systems,
                                   const Environment& environment, const SimulationOptions& options,
                                   const LaneKernel<Real>& kernel)
    : simulators_(SimulatorsOf(systems, environment, options)),
      kernel_(kernel),
      workspaces_(simulators_.begin(), simulators_.end()),
      step_(StepOfFrame()),
      state_(kLaneState * simulators_[0].step_.first_internal(), kernel.lanes),
      next_(state_),
      own_(kernel.lanes, nullptr) {}

template <class Real>
void LaneSimulator<Real>::AdvanceFrame(const std::vector<FrameInput>& inputs,
                                       const std::vector<State*>& states) {
  StopIfRequested();
  const int nodes = simulators_[0].node_count(), controllers = simulators_[0].controllers_;
  const int substeps = simulators_[0].options_.substeps;
  std::copy(states.begin(), states.end(), own_.begin());
  const int lanes = static_cast<int>(states.size());
  for (int l = 0; l < lanes; ++l) {
    if (own_[l]) simulators_[l].StartFrame(inputs[l], own_[l], &workspaces_[l]);
  }
  std::optional<LaneStep<Real>> own_step;
  const auto has_own = [](const Workspace& workspace) { return workspace.own_step.has_value(); };
  if (std::any_of(workspaces_.begin(), workspaces_.end(), has_own)) {
    own_step.emplace(StepOfFrame());
  }
  LaneStep<Real>& step = own_step ? *own_step : step_;
  step.Interleave(own_, 0, nodes, state_.data());
  for (int i = 0; i < substeps; ++i) {
    moving_.clear();
    for (int l = 0; l < lanes; ++l) {
      if (!own_[l]) continue;
      simulators_[l].PlaceControllers(inputs[l], i, own_[l]);
      moving_.push_back(
          {l, simulators_[l].NowOf(inputs[l], i, workspaces_[l]), own_[l], &workspaces_[l].next});
    }
    step.Interleave(own_, nodes, controllers, state_.data());
    step.Advance(moving_, state_.data(), next_.data());
    std::swap(state_, next_);
    for (const LaneNow<Real>& one : moving_) std::swap(*one.state, *one.next);
  }
  step.Separate(state_.data(), 0, nodes, own_);
  for (int l = 0; l < lanes; ++l) {
    if (own_[l]) simulators_[l].EndFrame(inputs[l], workspaces_[l], own_[l]);
  }
}

template class LaneSimulator<float>;
template class LaneSimulator<double>;

}  // namespace physpring
