// SPDX-License-Identifier: Apache-2.0
#include "trainer/motion/rollout.h"

#include <array>
#include <cmath>
#include <future>
#include <utility>

#include "trainer/motion/observer.h"
#include "twin/environment.h"
#include "twin/recorded_input.h"

namespace physpring {
namespace {

template <class Real>
class RolloutIn : public Rollout {
 public:
  RolloutIn(const SpringMassSystem& system, const Episode& episode, const RolloutOptions& options)
      : episode_(episode),
        recording_(*episode.recording),
        observer_gain_(options.observer_gain),
        growth_limit_(options.growth_limit),
        recording_ahead_(options.threads > 1 ? std::launch::async : std::launch::deferred),
        kicks_(options.kicks),
        delay_(ControllerDelay(system)),
        gradient_(system),
        simulator_(system, EnvironmentOf(recording_),
                   {1 / recording_.fps, options.substeps, options.controller_velocity,
                    LateGraspsOf(recording_)}),
        workspaces_{typename Simulator<Real>::Workspace(simulator_),
                    typename Simulator<Real>::Workspace(simulator_)} {
    states_.push_back(
        simulator_.MakeState(recording_.start.leftCols(system.node_count()), recording_.velocity));
    positions_.push_back(simulator_.Positions(states_[0]));
    for (int frame = 1; frame < episode.frames; ++frame) {
      if (kicks_) Kick((*kicks_)[static_cast<std::size_t>(frame) - 1], &states_.back());
      NodeStates<Real> state = states_.back();
      simulator_.AdvanceFrame(Input(frame), &state, &workspaces_[0]);
      Points position = simulator_.Positions(state);
      if (IsFarAway(position)) {
        diverged_ = true;
        break;
      }
      if (IsObserved(frame)) Observe(observer_gain_, recording_, frame, position, &state);
      positions_.push_back(std::move(position));
      states_.push_back(std::move(state));
    }
  }

  RolloutAdjoint Adjoint(const std::vector<Points>& position_bar) override {
    RolloutAdjoint result{gradient_, {}, {}, 0};
    if (kicks_) result.kicks_bar.resize(states_.size() - 1);
    NodeStates<Real> state_bar(states_[0].size());
    double injected_squared = 0;
    std::future<void> recorded = Record(states_.size() - 1);
    for (std::size_t frame = states_.size() - 1; frame >= 1; --frame) {
      const int at = static_cast<int>(frame);
      if (IsObserved(at)) ObserveAdjoint(observer_gain_, recording_, at, &state_bar);
      injected_squared += position_bar[frame].squaredNorm();
      const double norm = Add(position_bar[frame], &state_bar);
      if (norm > growth_limit_ * std::sqrt(injected_squared)) {
        ++result.cuts;
        state_bar.assign(state_bar.size(), {});
        Add(position_bar[frame], &state_bar);
      }
      recorded.get();
      if (frame > 1) recorded = Record(frame - 1);
      simulator_.RecordedFrameAdjoint(&state_bar, &result.gradient, &workspaces_[frame % 2]);
      if (kicks_) result.kicks_bar[frame - 1] = simulator_.Velocities(state_bar);
    }
    result.velocity_bar = simulator_.Velocities(state_bar);
    return result;
  }

 private:
  // Goes through a frame again for its adjoint, while that of the frame after it is worked out.
  std::future<void> Record(std::size_t frame) {
    return std::async(recording_ahead_, [this, frame] {
      NodeStates<Real> state = states_[frame - 1];
      simulator_.RecordFrame(Input(static_cast<int>(frame)), &state, &workspaces_[frame % 2]);
    });
  }

  bool IsObserved(int frame) const { return episode_.UseOf(frame) != FrameUse::kNone; }

  FrameInput Input(int frame) const { return RecordedInput(recording_, frame, delay_); }

  static void Kick(const Points& kick, NodeStates<Real>* state) {
    for (int i = 0; i < kick.cols(); ++i) {
      for (int j = 0; j < 3; ++j) (*state)[i].v[j] += static_cast<Real>(kick(j, i));
    }
  }

  // Adds to the positions' part of state_bar; returns the norm of the sum.
  static double Add(const Points& position_bar, NodeStates<Real>* state_bar) {
    double norm_squared = 0;
    for (int i = 0; i < position_bar.cols(); ++i) {
      for (int j = 0; j < 3; ++j) {
        Real& entry = (*state_bar)[i].x[j];
        entry += static_cast<Real>(position_bar(j, i));
        norm_squared += static_cast<double>(entry) * static_cast<double>(entry);
      }
    }
    return std::sqrt(norm_squared);
  }

  Episode episode_;
  const Recording& recording_;
  double observer_gain_;
  double growth_limit_;
  std::launch recording_ahead_;
  const std::vector<Points>* kicks_;
  double delay_;             // how late the controllers are, s
  SystemGradient gradient_;  // zero, of the right shapes
  Simulator<Real> simulator_;
  std::array<typename Simulator<Real>::Workspace, 2> workspaces_;  // for even and for odd frames
  std::vector<NodeStates<Real>> states_;                           // the state at each frame
};

}  // namespace

std::unique_ptr<Rollout> RollOut(const SpringMassSystem& system, const Episode& episode,
                                 const RolloutOptions& options) {
  if (options.single_precision) return std::make_unique<RolloutIn<float>>(system, episode, options);
  return std::make_unique<RolloutIn<double>>(system, episode, options);
}

}  // namespace physpring
