// SPDX-License-Identifier: Apache-2.0
#include "tests/support/lanes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "twin/lane_kernels.h"
#include "twin/lane_simulator.h"

namespace physpring {
namespace {

// The states after each frame.
template <class Real>
using Frames = std::vector<NodeStates<Real>>;

template <class Real>
Frames<Real> Alone(const TargetedRollout& rollout, const Kernel<Real>& kernel) {
  const Simulator<Real> simulator(rollout.system, rollout.environment, rollout.options, kernel);
  typename Simulator<Real>::Workspace workspace(simulator);
  NodeStates<Real> state = simulator.MakeState(rollout.position, rollout.velocity);
  Frames<Real> frames;
  for (const FrameInput& input : rollout.frames) {
    simulator.AdvanceFrame(input, &state, &workspace);
    frames.push_back(state);
  }
  return frames;
}

template <class Real>
std::vector<Frames<Real>> SideBySide(const std::vector<TargetedRollout>& rollouts,
                                     const LaneKernel<Real>& kernel) {
  std::vector<SpringMassSystem> systems;
  for (const TargetedRollout& rollout : rollouts) systems.push_back(rollout.system);
  LaneSimulator<Real> simulator(systems, rollouts[0].environment, rollouts[0].options, kernel);
  Frames<Real> states;
  std::vector<NodeStates<Real>*> moving;
  for (std::size_t i = 0; i < rollouts.size(); ++i) {
    states.push_back(simulator.simulator(static_cast<int>(i))
                         .MakeState(rollouts[i].position, rollouts[i].velocity));
  }
  for (NodeStates<Real>& state : states) moving.push_back(&state);
  std::vector<Frames<Real>> all(rollouts.size());
  for (std::size_t frame = 0; frame < rollouts[0].frames.size(); ++frame) {
    std::vector<FrameInput> inputs;
    for (const TargetedRollout& rollout : rollouts) inputs.push_back(rollout.frames[frame]);
    simulator.AdvanceFrame(inputs, moving);
    for (std::size_t i = 0; i < states.size(); ++i) all[i].push_back(states[i]);
  }
  return all;
}

// The fourth numbers of a node are padding, and mean nothing.
template <class Real>
bool SameBits(const NodeStates<Real>& p, const NodeStates<Real>& q) {
  return p.size() == q.size() &&
         std::memcmp(p.data(), q.data(), p.size() * sizeof(NodeState<Real>)) == 0;
}

template <class Real>
std::string Difference(const std::vector<TargetedRollout>& rollouts, const char* name) {
  const LaneKernel<Real>* lanes = FindLaneKernel<Real>(name);
  if (lanes == nullptr) return "";
  for (auto first = rollouts.begin(); first != rollouts.end();) {
    const auto end = first + std::min<std::ptrdiff_t>(lanes->lanes, rollouts.end() - first);
    const auto all = SideBySide<Real>({first, end}, *lanes);
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (const Kernel<Real>* kernel : {FindKernel<Real>("scalar"), &ChooseKernel<Real>("")}) {
        const Frames<Real> alone = Alone<Real>(first[static_cast<std::ptrdiff_t>(i)], *kernel);
        for (std::size_t frame = 0; frame < alone.size(); ++frame) {
          if (SameBits(all[i][frame], alone[frame])) continue;
          return fmt::format("{} lanes of {}, lane {}, frame {}: not the bits of {}", lanes->lanes,
                             name, i, frame + 1, kernel->name);
        }
      }
    }
    first = end;
  }
  return "";
}

}  // namespace

std::string DifferenceSideBySide(const std::vector<TargetedRollout>& rollouts) {
  for (const char* name : {"avx2", "avx512"}) {
    for (const std::string& difference :
         {Difference<float>(rollouts, name), Difference<double>(rollouts, name)}) {
      if (!difference.empty()) return difference;
    }
  }
  return "";
}

bool HasLanes() { return FindLaneKernel<double>("avx2") != nullptr; }

}  // namespace physpring
