// SPDX-License-Identifier: Apache-2.0
#include "twin/path_simulator.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "twin/effects/effect_set.h"
#include "twin/error.h"
#include "twin/recorded_input.h"
#include "twin/simulator.h"

namespace physpring {
namespace {

// A path as a recording has it.
Recording RecordingOf(const std::vector<Points>& path, double fps) {
  Recording recording;
  recording.controllers = path;
  recording.fps = fps;
  return recording;
}

template <class Real>
class PathSimulatorIn : public PathSimulator {
 public:
  PathSimulatorIn(const SpringMassSystem& system, const Environment& environment,
                  const PathOptions& options)
      : controllers_(system.controllers),
        fps_(options.fps),
        delay_(ControllerDelay(system)),
        gradient_(system),
        simulator_(system, environment,
                   {1 / options.fps, options.substeps, options.controller_velocity, {}}) {}

  PathMotion Roll(const PathStart& start, const std::vector<Points>& path) const override {
    const Recording recording = RecordingOf(path, fps_);
    Workspace workspace(simulator_);
    State state = simulator_.MakeState(start.position, start.velocity);
    PathMotion motion;
    Keep(state, &motion);
    for (int frame = 1; frame < static_cast<int>(path.size()); ++frame) {
      AdvanceTo(frame, recording, &state, &workspace);
      Keep(state, &motion);
    }
    return motion;
  }

  PathGradient Gradient(const PathStart& start, const std::vector<Points>& path,
                        const std::vector<Points>& position_bar,
                        const std::vector<Points>& velocity_bar) const override {
    const Recording recording = RecordingOf(path, fps_);
    Workspace workspace(simulator_);
    std::vector<State> states{simulator_.MakeState(start.position, start.velocity)};
    for (int frame = 1; frame < static_cast<int>(path.size()); ++frame) {
      states.push_back(states.back());
      AdvanceTo(frame, recording, &states.back(), &workspace);
    }
    PathGradient gradient{gradient_, {}, {}, {}};
    gradient.controllers.assign(path.size(), Points::Zero(3, path[0].cols()));
    State state_bar(states[0].size());
    for (std::size_t frame = path.size(); frame-- > 0;) {
      Add(position_bar[frame], &NodeState<Real>::x, &state_bar);
      if (!velocity_bar.empty()) Add(velocity_bar[frame], &NodeState<Real>::v, &state_bar);
      if (frame == 0) break;
      const int at = static_cast<int>(frame);
      simulator_.AdvanceFrameAdjoint(states[frame - 1], RecordedInput(recording, at, delay_),
                                     &state_bar, &gradient.system, &workspace);
      RecordedInputAdjoint(recording, at, delay_, workspace.controllers_start_bar(),
                           workspace.controllers_end_bar(), &gradient.controllers);
    }
    gradient.position = simulator_.Positions(state_bar);
    gradient.velocity = simulator_.Velocities(state_bar);
    return gradient;
  }

  PathState MakeState(const PathStart& start, const Points& controllers) const override {
    return {fps_, Pack(simulator_.MakeState(start.position, start.velocity)), {controllers}};
  }

  void ExpectOwn(const PathState& state) const override {
    const Points none = Points::Zero(3, simulator_.node_count());
    const std::size_t size = 8 * simulator_.MakeState(none, none).size();
    const auto is_own = [&](const Points& controllers) {
      return controllers.cols() == controllers_;
    };
    const bool right = state.fps == fps_ && state.nodes.size() == size && !state.path.empty() &&
                       std::all_of(state.path.begin(), state.path.end(), is_own);
    if (!right) throw Error("the state is that of a simulator of another level or other frames");
  }

  void Advance(const Points& controllers, PathState* state) const override {
    std::vector<Points> path = state->path;
    path.push_back(controllers);
    const int frame = static_cast<int>(path.size()) - 1;
    Workspace workspace(simulator_);
    State nodes = Unpack(state->nodes);
    AdvanceTo(frame, RecordingOf(path, fps_), &nodes, &workspace);
    *state = {fps_, Pack(nodes), std::move(path)};
  }

  PathStart Of(const PathState& state) const override {
    const State nodes = Unpack(state.nodes);
    return {simulator_.Positions(nodes), simulator_.Velocities(nodes)};
  }

 private:
  using State = NodeStates<Real>;
  using Workspace = typename Simulator<Real>::Workspace;

  void AdvanceTo(int frame, const Recording& recording, State* state, Workspace* workspace) const {
    simulator_.AdvanceFrame(RecordedInput(recording, frame, delay_), state, workspace);
    if (!IsFarAway(simulator_.Positions(*state)) && simulator_.Velocities(*state).allFinite()) {
      return;
    }
    throw Error(
        fmt::format("the motion diverges in frame {} with {} sub-steps a frame; more sub-steps are "
                    "needed",
                    frame, simulator_.options().substeps));
  }

  void Keep(const State& state, PathMotion* motion) const {
    motion->position.push_back(simulator_.Positions(state));
    motion->velocity.push_back(simulator_.Velocities(state));
  }

  static void Add(const Points& bar, Real (NodeState<Real>::*part)[4], State* state_bar) {
    for (int i = 0; i < bar.cols(); ++i) {
      for (int j = 0; j < 3; ++j) ((*state_bar)[i].*part)[j] += static_cast<Real>(bar(j, i));
    }
  }

  static std::vector<double> Pack(const State& state) {
    std::vector<double> numbers;
    for (const NodeState<Real>& node : state) {
      numbers.insert(numbers.end(), node.x, node.x + 4);
      numbers.insert(numbers.end(), node.v, node.v + 4);
    }
    return numbers;
  }
  static State Unpack(const std::vector<double>& numbers) {
    State state(numbers.size() / 8);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      Real* const part = i % 8 < 4 ? state[i / 8].x : state[i / 8].v;
      part[i % 4] = static_cast<Real>(numbers[i]);
    }
    return state;
  }

  int controllers_;
  double fps_, delay_;       // delay: how late the controllers are, s
  SystemGradient gradient_;  // zero, of the right shapes
  Simulator<Real> simulator_;
};

}  // namespace

std::unique_ptr<PathSimulator> MakePathSimulator(const SpringMassSystem& system,
                                                 const Environment& environment,
                                                 const PathOptions& options) {
  system.Validate("the level");
  if (options.single_precision) {
    return std::make_unique<PathSimulatorIn<float>>(system, environment, options);
  }
  return std::make_unique<PathSimulatorIn<double>>(system, environment, options);
}

}  // namespace physpring
