// SPDX-License-Identifier: Apache-2.0
#include "twin/simulator.h"

#include <algorithm>
#include <utility>

#include "twin/stop_request.h"

namespace physpring {

template <class Real>
Simulator<Real>::Simulator(const SpringMassSystem& system, const Environment& environment,
                           const SimulationOptions& options, const Kernel<Real>& kernel)
    : nodes_(system.node_count()),
      controllers_(system.controllers),
      options_(options),
      h_(options.frame_time / options.substeps),
      step_(system, environment, kernel),
      grasps_(system, options.late, step_.springs(), step_.state_size()) {
  const Setting& changed = step_.effects().changed();
  node_step_.Set(changed.system, h_, changed.gravity);
}

template <class Real>
void Simulator<Real>::SetParameters(const SpringMassSystem& system) {
  step_.SetParameters(system);
  const Setting& changed = step_.effects().changed();
  node_step_.Set(changed.system, h_, changed.gravity);
}

template <class Real>
typename Simulator<Real>::State Simulator<Real>::MakeState(const Points& position,
                                                           const Points& velocity) const {
  State state(state_size());
  for (int i = 0; i < nodes_; ++i) {
    for (int j = 0; j < 3; ++j) {
      state[i].x[j] = static_cast<Real>(position(j, i));
      state[i].v[j] = static_cast<Real>(velocity(j, i));
    }
  }
  return state;
}

template <class Real>
Points Simulator<Real>::Positions(const State& state) const {
  Points position(3, nodes_);
  for (int i = 0; i < nodes_; ++i) {
    for (int j = 0; j < 3; ++j) position(j, i) = static_cast<double>(state[i].x[j]);
  }
  return position;
}

template <class Real>
Points Simulator<Real>::Velocities(const State& state) const {
  Points velocity(3, nodes_);
  for (int i = 0; i < nodes_; ++i) {
    for (int j = 0; j < 3; ++j) velocity(j, i) = static_cast<double>(state[i].v[j]);
  }
  return velocity;
}

template <class Real>
Eigen::VectorXd Simulator<Real>::RestLengths(const State& state) const {
  Eigen::VectorXd length = step_.effects().changed().system.rest_length;
  grasps_.AddShifts(state, &length);
  return length;
}

template <class Real>
void Simulator<Real>::PlaceControllers(const FrameInput& input, int substep, State* state) const {
  const double fraction = static_cast<double>(substep + 1) / options_.substeps;
  for (int c = 0; c < controllers_; ++c) {
    NodeState<Real>& controller = (*state)[nodes_ + c];
    for (int j = 0; j < 3; ++j) {
      const double from = input.controllers_start(j, c), to = input.controllers_end(j, c);
      controller.x[j] = static_cast<Real>(from + (to - from) * fraction);
      controller.v[j] =
          options_.controller_velocity ? static_cast<Real>((to - from) / options_.frame_time) : 0;
    }
  }
}

template <class Real>
void Simulator<Real>::StartFrame(const FrameInput& input, State* state,
                                 Workspace* workspace) const {
  workspace->pairs = step_.contact().FindPairs(*state, options_.frame_time);
  workspace->controller_velocity =
      (input.controllers_end - input.controllers_start) / options_.frame_time;
  workspace->own_step.reset();
  if (input.released.empty() && !grasps_.has_late()) return;
  grasps_.Attach(input.attached, state);
  workspace->start = *state;
  workspace->own_step = step_;
  grasps_.Apply(input.released, *state, &*workspace->own_step);
}

template <class Real>
void Simulator<Real>::EndFrame(const FrameInput& input, const Workspace& workspace,
                               State* state) const {
  PlaceControllers(input, options_.substeps - 1, state);
  if (workspace.own_step) grasps_.CopyShifts(workspace.start, state);
}

template <class Real>
const LevelStep<Real>& Simulator<Real>::StepOf(const Workspace& workspace) const {
  return workspace.own_step ? *workspace.own_step : step_;
}

template <class Real>
LevelSubstep<Real> Simulator<Real>::NowOf(const FrameInput& input, int substep,
                                          const Workspace& workspace) const {
  return {node_step_.View(), input.time, substep * h_, h_, workspace.controller_velocity,
          workspace.pairs,   input.geoms};
}

template <class Real>
void Simulator<Real>::Substep(const FrameInput& input, int substep, State* state, State* next,
                              typename LevelStep<Real>::Impacts* impacts,
                              Workspace* workspace) const {
  PlaceControllers(input, substep, state);
  StepOf(*workspace)
      .Advance(NowOf(input, substep, *workspace), *state, next, impacts, &workspace->buffers,
               [](State*) {});
}

template <class Real>
void Simulator<Real>::SubstepAdjoint(int substep, State* state_bar, Workspace* workspace) const {
  const LevelStep<Real>& step = StepOf(*workspace);
  step.AdvanceAdjoint(NowOf(workspace->input, substep, *workspace), workspace->states[substep],
                      &workspace->states[substep + 1], &workspace->impacts[substep], state_bar,
                      &workspace->buffers);
  step.effects().TakeControllers(static_cast<double>(substep + 1) / options_.substeps,
                                 options_.controller_velocity ? options_.frame_time : 0, state_bar,
                                 &workspace->buffers.effects);
}

template <class Real>
void Simulator<Real>::AdvanceFrame(const FrameInput& input, State* state,
                                   Workspace* workspace) const {
  StopIfRequested();
  StartFrame(input, state, workspace);
  if (workspace->impacts.empty()) workspace->impacts.resize(1);
  for (int i = 0; i < options_.substeps; ++i) {
    Substep(input, i, state, &workspace->next, &workspace->impacts[0], workspace);
    std::swap(*state, workspace->next);
  }
  EndFrame(input, *workspace, state);
}

template <class Real>
void Simulator<Real>::AdvanceFrameAdjoint(const State& start, const FrameInput& input,
                                          State* state_bar, SystemGradient* gradient,
                                          Workspace* workspace) const {
  State state = start;
  RecordFrame(input, &state, workspace);
  RecordedFrameAdjoint(state_bar, gradient, workspace);
}

template <class Real>
void Simulator<Real>::RecordFrame(const FrameInput& input, State* state,
                                  Workspace* workspace) const {
  StopIfRequested();
  StartFrame(input, state, workspace);
  workspace->states.resize(options_.substeps + 1, State(state->size()));
  workspace->impacts.resize(options_.substeps);
  workspace->states[0] = *state;
  for (int i = 0; i < options_.substeps; ++i) {
    Substep(input, i, &workspace->states[i], &workspace->states[i + 1], &workspace->impacts[i],
            workspace);
  }
  workspace->input = input;
  *state = workspace->states[options_.substeps];
  EndFrame(input, *workspace, state);
}

template <class Real>
void Simulator<Real>::RecordedFrameAdjoint(State* state_bar, SystemGradient* gradient,
                                           Workspace* workspace) const {
  StopIfRequested();
  LevelBuffers<Real>& buffers = workspace->buffers;
  const FrameInput& input = workspace->input;
  const LevelStep<Real>& step = StepOf(*workspace);
  step.ClearGradient(&buffers);
  for (int i = options_.substeps - 1; i >= 0; --i) SubstepAdjoint(i, state_bar, workspace);
  // the controllers' motion is given: what was added to them does not count
  std::fill(state_bar->begin() + nodes_, state_bar->begin() + step.first_internal(),
            NodeState<Real>{});
  SystemGradient frame(step.effects().changed().system);
  step.AddGradients(node_step_.View(), h_, buffers, &frame);
  if (workspace->own_step) grasps_.ApplyAdjoint(input.released, &frame);
  step.effects().FinishControllers(options_.frame_time, &buffers.effects);
  workspace->controllers_start_bar_ = buffers.effects.start_bar;
  workspace->controllers_end_bar_ = buffers.effects.end_bar;
  step.effects().FinishGradient(input.delay_rate_start, input.delay_rate_end, buffers.effects,
                                &frame);
  *gradient += frame;
}

template class Simulator<float>;
template class Simulator<double>;

}  // namespace physpring
