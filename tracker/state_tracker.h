// SPDX-License-Identifier: Apache-2.0
// Where are all nodes of a body of which some points are seen? The body's model predicts a frame
// (whoever has the tracker moves its state on), and what is measured corrects it: named points, or
// a cloud of points without names. The correction moves the body as a whole (smooth_correction.h)
// and its velocities with it. A cloud is matched again as the body is pulled towards it, softly at
// first (soft_match.h), to the nodes on the surface that it shows (seen_nodes.h).
//
// How much a measurement counts beside the model is for the caller to say: tracker_bank.h tries
// several.
#ifndef PHYSPRING_TRACKER_STATE_TRACKER_H_
#define PHYSPRING_TRACKER_STATE_TRACKER_H_

#include <limits>
#include <memory>

#include "tracker/seen_nodes.h"
#include "tracker/smooth_correction.h"
#include "twin/simulator.h"

namespace physpring {

// What is measured in a frame, m. Both may be empty.
struct FrameMeasurement {
  Points named;  // 3 x nodes or fewer: the first nodes; a column of NaN is not seen
  Points cloud;  // 3 x any number; a column of NaN is no point
  // How much each of those named counts beside the others (Recording::weight); empty: all alike.
  Eigen::RowVectorXd weight = {};
};

struct TrackerOptions {
  double noise = 1e-3;  // standard deviation of a measured coordinate, m
  // How far the prediction of a frame is off, in the noise of what corrects it (of a cloud: the
  // width of the match).
  double model_error = 1;
  int surface = 0;  // the first nodes, which clouds are more likely to show than the others
};

class StateTracker {
 public:
  // `simulator`: that of the body; it outlives the tracker. `correction`: that of its system.
  // `nodes`: where the nodes are at first, 3 x nodes, m. `velocity`: m/s, alike.
  StateTracker(const Simulator<double>& simulator,
               std::shared_ptr<const SmoothCorrection> correction, const TrackerOptions& options,
               const Points& nodes, const Points& velocity);

  // That of the last frame as it was corrected, to be moved on to the next frame.
  NodeStates<double>* state() { return &state_; }

  // After that. A motion that diverges is not finite from then on.
  void Correct(const FrameMeasurement& measured);

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
    double unmatched = 0;   // points of a cloud that belong to no node
    Eigen::VectorXd count;  // (nodes): how many belong to a node
  };
  Pull PullOfNamed(const FrameMeasurement& measured) const;
  void AddCloud(const Points& cloud, const Points& moved, double width, Pull* pull) const;
  // By which the measurements displace the nodes from where they are predicted.
  Points DisplacementBy(const FrameMeasurement& measured);
  void Judge(const Pull& pull, const Points& moved, double unit);
  void Move(const Points& displacement, double velocity_gain);

  TrackerOptions options_;
  double fps_;
  const Simulator<double>& simulator_;
  std::shared_ptr<const SmoothCorrection> correction_;
  SeenNodes seen_;
  double width_;  // of a match, m
  NodeStates<double> state_;
  Points position_, predicted_;
  // of the last correction: the part of what was measured that it took, and how far that was
  double gain_ = 1, surprise_ = std::numeric_limits<double>::infinity();
};

}  // namespace physpring

#endif  // PHYSPRING_TRACKER_STATE_TRACKER_H_
