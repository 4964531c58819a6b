// SPDX-License-Identifier: Apache-2.0
// The simulators of several systems side by side, frame by frame: Simulator::AdvanceFrame for each
// of them, with the same bits, in much less time. Between the frames each has a state of its own.
#ifndef PHYSPRING_TWIN_LANE_SIMULATOR_H_
#define PHYSPRING_TWIN_LANE_SIMULATOR_H_

#include <vector>

#include "twin/lane_step.h"
#include "twin/simulator.h"

namespace physpring {

// Whether the simulators of two systems may run side by side: the same springs between the same
// nodes, the same effects and the same collision distance.
bool AreAlike(const SpringMassSystem& a, const SpringMassSystem& b);

template <class Real>
class LaneSimulator {
 public:
  using State = NodeStates<Real>;

  // The systems are alike, and at most kernel.lanes. For one thread.
  LaneSimulator(const std::vector<SpringMassSystem>& systems, const Environment& environment,
                const SimulationOptions& options, const LaneKernel<Real>& kernel);
  LaneSimulator(const LaneSimulator&) = delete;
  LaneSimulator& operator=(const LaneSimulator&) = delete;

  // That of one system: it makes states and reads them.
  const Simulator<Real>& simulator(int lane) const { return simulators_[lane]; }

  // Advances the states by a frame: one state and one input for each system; all release the same
  // controllers. A system whose state is null stands still.
  void AdvanceFrame(const std::vector<FrameInput>& inputs, const std::vector<State*>& states);

 private:
  using Workspace = typename Simulator<Real>::Workspace;

  static std::vector<Simulator<Real>> SimulatorsOf(const std::vector<SpringMassSystem>& systems,
                                                   const Environment& environment,
                                                   const SimulationOptions& options);
  // The step of all simulators in the frame for which their workspaces were started.
  LaneStep<Real> StepOfFrame() const;

  std::vector<Simulator<Real>> simulators_;
  const LaneKernel<Real>& kernel_;
  std::vector<Workspace> workspaces_;
  LaneStep<Real> step_;  // where all controllers hold what they held at the start
  LaneArray<Real> state_, next_;
  std::vector<State*> own_;  // (lanes of the kernel) the states of those that move
  std::vector<LaneNow<Real>> moving_;
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_LANE_SIMULATOR_H_
