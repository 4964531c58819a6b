// SPDX-License-Identifier: Apache-2.0
#include "trainer/motion/lane_rollout.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "trainer/motion/observer.h"
#include "twin/environment.h"
#include "twin/lane_kernels.h"
#include "twin/lane_simulator.h"
#include "twin/recorded_input.h"

namespace physpring {
namespace {

using Motions = std::vector<std::optional<std::vector<Points>>>;

// Alike systems, as many as fit into the lanes of a kernel.
template <class Real>
class LaneRollout {
 public:
  LaneRollout(const std::vector<SpringMassSystem>& systems, const Episode& episode,
              const RolloutOptions& options, const LaneKernel<Real>& kernel)
      : episode_(episode),
        recording_(*episode.recording),
        observer_gain_(options.observer_gain),
        simulator_(systems, EnvironmentOf(recording_),
                   {1 / recording_.fps, options.substeps, options.controller_velocity,
                    LateGraspsOf(recording_)},
                   kernel),
        states_(systems.size()),
        moving_(systems.size()),
        motions_(systems.size()) {
    for (std::size_t i = 0; i < systems.size(); ++i) {
      const Simulator<Real>& simulator = simulator_.simulator(static_cast<int>(i));
      states_[i] = simulator.MakeState(recording_.start.leftCols(systems[i].node_count()),
                                       recording_.velocity);
      moving_[i] = &states_[i];
      motions_[i] = {simulator.Positions(states_[i])};
      delays_.push_back(ControllerDelay(systems[i]));
    }
    for (int frame = 1; frame < episode.frames; ++frame) Advance(frame);
  }

  Motions Take() { return std::move(motions_); }

 private:
  void Advance(int frame) {
    std::vector<FrameInput> inputs;
    for (double delay : delays_) inputs.push_back(RecordedInput(recording_, frame, delay));
    simulator_.AdvanceFrame(inputs, moving_);
    for (std::size_t i = 0; i < moving_.size(); ++i) {
      if (moving_[i] == nullptr) continue;
      Points position = simulator_.simulator(static_cast<int>(i)).Positions(states_[i]);
      if (IsFarAway(position)) {
        moving_[i] = nullptr;
        motions_[i] = {};
        continue;
      }
      if (episode_.UseOf(frame) != FrameUse::kNone) {
        Observe(observer_gain_, recording_, frame, position, &states_[i]);
      }
      motions_[i]->push_back(std::move(position));
    }
  }

  const Episode& episode_;
  const Recording& recording_;
  double observer_gain_;
  std::vector<double> delays_;  // how late the controllers are, s
  LaneSimulator<Real> simulator_;
  std::vector<NodeStates<Real>> states_;
  std::vector<NodeStates<Real>*> moving_;  // null: diverged
  Motions motions_;
};

std::optional<std::vector<Points>> RollOutAlone(const SpringMassSystem& system,
                                                const Episode& episode,
                                                const RolloutOptions& options) {
  const auto rollout = RollOut(system, episode, options);
  if (rollout->diverged()) return {};
  return rollout->positions();
}

template <class Real>
Motions RollOutIn(const std::vector<SpringMassSystem>& systems, const Episode& episode,
                  const RolloutOptions& options) {
  const bool alike =
      std::all_of(systems.begin(), systems.end(),
                  [&](const SpringMassSystem& system) { return AreAlike(system, systems[0]); });
  Motions all;
  for (auto first = systems.begin(); first != systems.end();) {
    const int left = static_cast<int>(systems.end() - first);
    const LaneKernel<Real>* kernel = alike ? BestLaneKernel<Real>(left) : nullptr;
    if (kernel == nullptr) {
      all.push_back(RollOutAlone(*first++, episode, options));
      continue;
    }
    const auto end = first + std::min(left, kernel->lanes);
    for (auto& motion : LaneRollout<Real>({first, end}, episode, options, *kernel).Take()) {
      all.push_back(std::move(motion));
    }
    first = end;
  }
  return all;
}

}  // namespace

std::vector<std::optional<std::vector<Points>>> RollOutSideBySide(
    const std::vector<SpringMassSystem>& systems, const Episode& episode,
    const RolloutOptions& options) {
  assert(options.kicks == nullptr);
  return options.single_precision ? RollOutIn<float>(systems, episode, options)
                                  : RollOutIn<double>(systems, episode, options);
}

}  // namespace physpring
