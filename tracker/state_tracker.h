// SPDX-License-Identifier: Apache-2.0
// Where are all nodes of a body of which some points are seen? The body's model predicts a frame,
// and what is measured corrects it: named points, or a cloud of points without names. The
// correction moves the body as a whole (smooth_correction.h) and its velocities with it. A cloud is
// matched again as the body is pulled towards it, softly at first (soft_match.h).
//
// How much a measurement counts beside the model is for the caller to say: tracker_bank.h tries
// several.
#ifndef PHYSPRING_TRACKER_STATE_TRACKER_H_
#define PHYSPRING_TRACKER_STATE_TRACKER_H_

#include <limits>
#include <memory>

#include "tracker/smooth_correction.h"
#include "twin/simulator.h"

namespace physpring {

// What is measured in a frame, m. Both may be empty.
struct FrameMeasurement {
  Points named;  // 3 x nodes or fewer: the first nodes; a column of NaN is not seen
  Points cloud;  // 3 x any number; a column of NaN is no point
};

struct TrackerOptions {
  double noise = 1e-3;  // standard deviation of a measured coordinate, m
  // How far the prediction of a frame is off, in the noise of what corrects it (of a cloud: the
  // width of the match).
  double model_error = 1;
};

class StateTracker {
 public:
  // `correction`: that of the system. `nodes`: where the nodes are at first, 3 x nodes, m.
  // `simulation.frame_time`: of a frame, s.
  StateTracker(const SpringMassSystem& system, std::shared_ptr<const SmoothCorrection> correction,
               const Environment& environment, const SimulationOptions& simulation,
               const TrackerOptions& options, const Points& nodes, const Points& velocity);

  // Goes on by one frame. A motion that diverges is not finite from then on.
  void Advance(const FrameInput& input, const FrameMeasurement& measured);

  const Points& position() const { return position_; }               // 3 x nodes, m, corrected
  Points velocity() const { return simulator_.Velocities(state_); }  // 3 x nodes, m/s
  // How far the measurements of the last frame that had any were from their prediction, root mean
  // square of a coordinate, m; infinite before it and after a divergence. A point of a cloud that
  // belongs to no node counts as far.
  double surprise() const { return surprise_; }

 private:
  // What pulls at the nodes: from where they are predicted to where, 3 x nodes, m, and how
  // precisely that is known, (nodes), 1/m^2.
  struct Pull {
    Points offset;
    Eigen::VectorXd precision;
    double unmatched = 0;  // points of a cloud that belong to no node
  };
  Pull PullOfNamed(const Points& named) const;
  void AddCloud(const Points& cloud, const Points& moved, double width, Pull* pull) const;
  // The displacements of the nodes from where they are predicted.
  Points Correct(const FrameMeasurement& measured);
  void Judge(const Pull& pull, const Points& moved, double unit);
  void Move(const Points& displacement, double velocity_gain);

  TrackerOptions options_;
  double fps_;
  Simulator<double> simulator_;
  Simulator<double>::Workspace workspace_;
  std::shared_ptr<const SmoothCorrection> correction_;
  double width_;  // of a match, m
  NodeStates<double> state_;
  Points position_, predicted_;
  // of the last correction: the part of what was measured that it took, and how far that was
  double gain_ = 1, surprise_ = std::numeric_limits<double>::infinity();
};

}  // namespace physpring

#endif  // PHYSPRING_TRACKER_STATE_TRACKER_H_
