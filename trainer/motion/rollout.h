// SPDX-License-Identifier: Apache-2.0
// The rollout of a recording's motion and its adjoint: one checkpoint a frame, sub-steps recomputed
// frame by frame on the way back, by a thread of their own where two are allowed.
//
// Gradients of long rollouts are of use only while the adjoint stays bounded. When, going back in
// time, its norm passes `growth_limit` times the norm of all that was put into it, it is set to
// zero there: the rollout falls into windows that are differentiated apart, and `cuts` counts them.
#ifndef PHYSPRING_TRAINER_MOTION_ROLLOUT_H_
#define PHYSPRING_TRAINER_MOTION_ROLLOUT_H_

#include <limits>
#include <memory>
#include <vector>

#include "trainer/data/episode.h"
#include "twin/simulator.h"

namespace physpring {

struct RolloutOptions {
  bool single_precision = false;
  bool controller_velocity = true;
  int substeps = 0;  // sub-steps a frame, >= 1
  double growth_limit = 1e3;
  double observer_gain = 0;  // observer.h; 0: none
  int threads = 1;           // at most so many; the result does not depend on it
  // Added to the velocities at frames 0, 1, ... (after an observer's correction), 3 x nodes, m/s:
  // as many as there are steps from frame to frame. They must outlive the rollout.
  const std::vector<Points>* kicks = nullptr;
};

struct RolloutAdjoint {
  SystemGradient gradient;
  Points velocity_bar;            // d loss / d initial velocity, 3 x nodes
  std::vector<Points> kicks_bar;  // d loss / d velocities, or kicks, at frames 0, 1, ...
  int cuts = 0;
};

class Rollout {
 public:
  virtual ~Rollout() = default;

  // Positions of frames 0, 1, ... (3 x nodes, m), before an observer's correction; the frames
  // after a divergence are missing.
  const std::vector<Points>& positions() const { return positions_; }
  bool diverged() const { return diverged_; }

  // Derivatives of a loss whose derivatives with respect to positions() are position_bar (one a
  // frame, 3 x nodes). Needs a rollout that did not diverge.
  virtual RolloutAdjoint Adjoint(const std::vector<Points>& position_bar) = 0;

 protected:
  std::vector<Points> positions_;
  bool diverged_ = false;
};

std::unique_ptr<Rollout> RollOut(const SpringMassSystem& system, const Episode& episode,
                                 const RolloutOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_MOTION_ROLLOUT_H_
