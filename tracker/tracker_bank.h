// SPDX-License-Identifier: Apache-2.0
// Trackers that trust their model more or less, side by side. The state is that of the one that
// has predicted best of late what was then measured. How good a model is need not be known, and
// may change.
//   Magill, Optimal adaptive estimation of sampled stochastic processes, IEEE Trans. Autom. Control
//   10 (1965).
#ifndef PHYSPRING_TRACKER_TRACKER_BANK_H_
#define PHYSPRING_TRACKER_TRACKER_BANK_H_

#include <memory>
#include <vector>

#include "tracker/side_by_side.h"
#include "tracker/state_tracker.h"

namespace physpring {

class TrackerBank {
 public:
  // `simulation.frame_time`: of a frame, s. `nodes`: where the nodes are at first, 3 x nodes, m.
  // `velocity`: m/s, alike. `noise`: standard deviation of a measured coordinate, m; a cloud needs
  // none. `surface`: how many nodes are on it, the first ones.
  TrackerBank(const SpringMassSystem& system, const Environment& environment,
              const SimulationOptions& simulation, double noise, int surface, const Points& nodes,
              const Points& velocity);

  // Goes on by one frame. A controller that takes hold takes hold of the body as the best tracker
  // has it.
  void Advance(FrameInput input, const FrameMeasurement& measured);

  // The one whose state is the best.
  const StateTracker& best() const { return trackers_[best_]; }

 private:
  double fps_;
  std::unique_ptr<SideBySide> simulators_;
  std::vector<StateTracker> trackers_;
  std::vector<double> surprise_;  // (trackers): mean square of late, m^2
  std::size_t best_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRACKER_TRACKER_BANK_H_
