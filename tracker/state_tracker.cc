// SPDX-License-Identifier: Apache-2.0
#include "tracker/state_tracker.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "twin/neighbours.h"

namespace physpring {
namespace {

constexpr double kWidth = 0.4;  // of a match in the end, in the nodes' spacing
// A cloud is matched again and again in a frame, each time with a width of this part of the last
// one. It begins at so many times what the prediction was wrong by in the last frame, and at no
// more than so many times the width in the end.
constexpr double kNarrower = 0.5, kSurprise = 2, kWidest = 3;
constexpr double kNone = 0.05;  // soft_match.h

}  // namespace

StateTracker::StateTracker(const SpringMassSystem& system, const Environment& environment,
                           const SimulationOptions& simulation, const TrackerOptions& options,
                           const Points& nodes, const Points& velocity)
    : options_(options),
      fps_(1 / simulation.frame_time),
      simulator_(system, environment, simulation),
      workspace_(simulator_),
      correction_(system),
      state_(simulator_.MakeState(nodes, velocity)),
      position_(nodes),
      predicted_(nodes) {
  const double spacing = nodes.cols() > 1 ? MedianSpacing(nodes) : options.noise;
  width_ = std::max(kWidth * spacing, options.noise);
}

void StateTracker::Advance(const FrameInput& input, const FrameMeasurement& measured) {
  simulator_.AdvanceFrame(input, &state_, &workspace_);
  predicted_ = simulator_.Positions(state_);
  if (!predicted_.allFinite()) {
    position_ = predicted_;
    surprise_ = std::numeric_limits<double>::infinity();
    return;
  }
  const Points moved = Correct(measured);
  Move(moved, gain_ / (2 - gain_));  // Benedict and Bordner's choice, of the gain that it has
}

Points StateTracker::Correct(const FrameMeasurement& measured) {
  const Points& from = predicted_;
  const Eigen::Index nodes = from.cols(), named = std::min(nodes, measured.named.cols());
  Eigen::VectorXd of_named = Eigen::VectorXd::Zero(nodes);
  Points named_offset = Points::Zero(3, nodes);
  for (Eigen::Index i = 0; i < named; ++i) {
    if (!measured.named.col(i).allFinite()) continue;
    of_named[i] = 1 / (options_.noise * options_.noise);
    named_offset.col(i) = measured.named.col(i) - from.col(i);
  }
  Points offset = named_offset, moved = Points::Zero(3, nodes);
  Eigen::VectorXd precision = of_named;
  const bool has_cloud = measured.cloud.cols() > 0;
  if (!has_cloud)
    moved = correction_.Solve(offset, precision, options_.model_error * options_.noise);
  for (double width = std::clamp(kSurprise * surprise_, width_ / kNarrower, kWidest * width_);
       has_cloud && width >= width_;
       width = width > width_ ? std::max(width_, kNarrower * width) : 0) {
    match_ = MatchSoftly(from + moved, measured.cloud, width, kNone);
    const Eigen::VectorXd of_cloud = match_.count / (width * width);
    precision = of_named + of_cloud;
    offset = named_offset * of_named.asDiagonal() + (match_.target - from) * of_cloud.asDiagonal();
    for (Eigen::Index i = 0; i < nodes; ++i) {
      if (precision[i] > 0) offset.col(i) /= precision[i];
    }
    moved = correction_.Solve(offset, precision, options_.model_error * width_);
  }
  Judge(offset, precision, moved);
  return moved;
}

void StateTracker::Judge(const Points& offset, const Eigen::VectorXd& precision,
                         const Points& moved) {
  const Points weighted = offset * precision.asDiagonal();
  const double all = weighted.cwiseProduct(offset).sum();
  gain_ = all > 0 ? std::clamp(weighted.cwiseProduct(moved).sum() / all, 0.0, 1.0) : 0;
  surprise_ = all > 0 ? std::sqrt(all / precision.sum() / 3) : 0;
}

void StateTracker::Move(const Points& displacement, double velocity_gain) {
  for (Eigen::Index i = 0; i < displacement.cols(); ++i) {
    NodeState<double>& node = state_[static_cast<std::size_t>(i)];
    for (int j = 0; j < 3; ++j) {
      node.x[j] += displacement(j, i);
      node.v[j] += velocity_gain * fps_ * displacement(j, i);
    }
  }
  position_ = simulator_.Positions(state_);
}

}  // namespace physpring
