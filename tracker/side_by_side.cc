// SPDX-License-Identifier: Apache-2.0
#include "tracker/side_by_side.h"

#include "twin/lane_kernels.h"

namespace physpring {

SideBySide::SideBySide(const SpringMassSystem& system, const Environment& environment,
                       const SimulationOptions& options, int count)
    : simulator_(system, environment, options), workspace_(simulator_) {
  const LaneKernel<double>* kernel = BestLaneKernel<double>(count);
  if (kernel == nullptr || kernel->lanes < count) return;
  const std::vector<SpringMassSystem> systems(static_cast<std::size_t>(count), system);
  lanes_ = std::make_unique<LaneSimulator<double>>(systems, environment, options, *kernel);
}

void SideBySide::AdvanceFrame(const FrameInput& input,
                              const std::vector<NodeStates<double>*>& states) {
  if (lanes_) {
    lanes_->AdvanceFrame(std::vector<FrameInput>(states.size(), input), states);
    return;
  }
  for (NodeStates<double>* state : states) simulator_.AdvanceFrame(input, state, &workspace_);
}

}  // namespace physpring
