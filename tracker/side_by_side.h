// SPDX-License-Identifier: Apache-2.0
// A body that moves on from several states at once: Simulator::AdvanceFrame for each of them, with
// the same bits. They go in the lanes of vectors where the processor has these
// (twin/lane_simulator.h), else one after the other.
#ifndef PHYSPRING_TRACKER_SIDE_BY_SIDE_H_
#define PHYSPRING_TRACKER_SIDE_BY_SIDE_H_

#include <memory>
#include <vector>

#include "twin/lane_simulator.h"
#include "twin/simulator.h"

namespace physpring {

class SideBySide {
 public:
  SideBySide(const SpringMassSystem& system, const Environment& environment,
             const SimulationOptions& options, int count);

  // Makes states and reads them.
  const Simulator<double>& simulator() const { return simulator_; }

  // `states`: `count` of them.
  void AdvanceFrame(const FrameInput& input, const std::vector<NodeStates<double>*>& states);

 private:
  Simulator<double> simulator_;
  Simulator<double>::Workspace workspace_;
  std::unique_ptr<LaneSimulator<double>> lanes_;  // null without lanes
};

}  // namespace physpring

#endif  // PHYSPRING_TRACKER_SIDE_BY_SIDE_H_
