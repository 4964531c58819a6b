// SPDX-License-Identifier: Apache-2.0
// PhysTwin's second stage: Adam on ln Y of every spring and on the contact coefficients, a step
// after every frame with gradients that reach back that one frame (frame_walk.h). The parameters
// change while the motion goes on. Y is clamped to [0, 1e5] N, the coefficients to their ranges;
// beyond, a parameter has no gradient.
#ifndef PHYSPRING_TRAINER_FITS_FIRST_ORDER_STAGE_H_
#define PHYSPRING_TRAINER_FITS_FIRST_ORDER_STAGE_H_

#include <limits>
#include <vector>

#include "trainer/motion/rollout.h"
#include "trainer/solvers/adam.h"
#include "twin/recording.h"
#include "twin/simulator.h"

namespace physpring {

class FirstOrderStage {
 public:
  // Starts from `start`, which gives topology and everything that is not learned, and makes at most
  // `most_passes` passes.
  FirstOrderStage(const SpringMassSystem& start, int most_passes);

  // Whether the last pass is done, or one diverged.
  bool done() const { return diverged_ || passes_ == most_passes_; }
  int passes() const { return passes_; }
  int steps() const { return adam_.steps; }                  // of Adam, a frame each
  const Eigen::VectorXd& values() const { return values_; }  // ln Y of each spring, then contact's
  bool diverged() const { return diverged_; }
  double last_loss() const { return last_loss_; }  // of the last pass, mean over frames, m^2

  // Once through the fit frames of all recordings, which walk at the same time: each step takes
  // the mean of their gradients. Bit for bit the same for any number of threads.
  void Pass(const std::vector<Recording>& recordings, const RolloutOptions& options, int threads);

  // As the next pass starts from, and as the best of those passes that are looked at (every 20th
  // and the last) left it; the start if there is none.
  SpringMassSystem Current() const { return With(values_); }
  SpringMassSystem Best() const { return With(best_); }
  double best_loss() const { return best_loss_; }

  // What a journal keeps (journal/packing.h).
  template <class Visitor>
  void Visit(Visitor&& visit) {
    visit(values_, adam_, passes_, diverged_, last_loss_, best_, best_loss_);
  }

 private:
  SpringMassSystem With(const Eigen::VectorXd& values) const;
  Eigen::VectorXd Derivatives(const SystemGradient& gradient) const;  // at values_

  SpringMassSystem start_;
  int most_passes_;
  double mass_;             // of a particle, kg
  Eigen::VectorXd values_;  // ln Y of each spring, coefficients of the ground, of particles
  Adam adam_;
  int passes_ = 0;
  bool diverged_ = false;
  double last_loss_ = 0;
  Eigen::VectorXd best_;
  double best_loss_ = std::numeric_limits<double>::infinity();
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_FIRST_ORDER_STAGE_H_
