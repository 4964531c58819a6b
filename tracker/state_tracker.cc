// SPDX-License-Identifier: Apache-2.0
#include "tracker/state_tracker.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tracker/soft_match.h"
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

StateTracker::StateTracker(const Simulator<double>& simulator,
                           std::shared_ptr<const SmoothCorrection> correction,
                           const TrackerOptions& options, const Points& nodes,
                           const Points& velocity)
    : options_(options),
      fps_(1 / simulator.options().frame_time),
      simulator_(simulator),
      correction_(std::move(correction)),
      seen_(simulator.node_count(), options.surface),
      state_(simulator.MakeState(nodes, velocity)),
      position_(nodes),
      predicted_(nodes) {
  const double spacing = nodes.cols() > 1 ? MedianSpacing(nodes) : options.noise;
  width_ = std::max(kWidth * spacing, options.noise);
}

void StateTracker::Correct(const FrameMeasurement& measured) {
  predicted_ = simulator_.Positions(state_);
  if (!predicted_.allFinite()) {
    position_ = predicted_;
    surprise_ = std::numeric_limits<double>::infinity();
    return;
  }
  const Points moved = DisplacementBy(measured);
  Move(moved, gain_ / (2 - gain_));  // Benedict and Bordner's choice, of the gain that it has
}

StateTracker::Pull StateTracker::PullOfNamed(const FrameMeasurement& measured) const {
  const Points& named = measured.named;
  const Eigen::Index nodes = predicted_.cols();
  Pull pull{Points::Zero(3, nodes), Eigen::VectorXd::Zero(nodes), 0, {}};
  for (Eigen::Index i = 0; i < std::min(nodes, named.cols()); ++i) {
    if (!named.col(i).allFinite()) continue;
    pull.offset.col(i) = named.col(i) - predicted_.col(i);
    const double weight = measured.weight.size() > 0 ? measured.weight[i] : 1;
    pull.precision[i] = weight / (options_.noise * options_.noise);
  }
  return pull;
}

void StateTracker::AddCloud(const Points& cloud, const Points& moved, double width,
                            Pull* pull) const {
  const SoftMatch match = MatchSoftly(predicted_ + moved, seen_.weight(), cloud, width, kNone);
  for (Eigen::Index i = 0; i < match.count.size(); ++i) {
    if (!(match.count[i] > 0)) continue;
    const double precision = match.count[i] / (width * width);
    const Eigen::Vector3d offset = match.target.col(i) - predicted_.col(i);
    const double both = pull->precision[i] + precision;
    pull->offset.col(i) += precision / both * (offset - pull->offset.col(i));
    pull->precision[i] = both;
  }
  pull->unmatched = cloud.row(0).array().isFinite().count() - match.count.sum();
  pull->count = match.count;
}

Points StateTracker::DisplacementBy(const FrameMeasurement& measured) {
  const Pull named = PullOfNamed(measured);
  const bool has_cloud = measured.cloud.array().isFinite().any();
  const double unit = has_cloud ? width_ : options_.noise;
  if (!has_cloud) {
    const Points moved =
        correction_->Solve(named.offset, named.precision, options_.model_error * unit);
    Judge(named, moved, unit);
    return moved;
  }
  Points moved = Points::Zero(3, predicted_.cols());
  double width = std::clamp(kSurprise * surprise_, width_ / kNarrower, kWidest * width_);
  for (;; width = std::max(width_, kNarrower * width)) {
    Pull pull = named;
    AddCloud(measured.cloud, moved, width, &pull);
    const bool last = width <= width_;
    moved = correction_->Solve(
        pull.offset, pull.precision, options_.model_error * unit,
        last ? SmoothCorrection::Detail::kFull : SmoothCorrection::Detail::kCoarse);
    if (!last) continue;
    Judge(pull, moved, unit);
    seen_.Learn(pull.count, 1 / fps_);
    return moved;
  }
}

void StateTracker::Judge(const Pull& pull, const Points& moved, double unit) {
  const Points weighted = pull.offset * pull.precision.asDiagonal();
  const double all = weighted.cwiseProduct(pull.offset).sum();
  gain_ = all > 0 ? std::clamp(weighted.cwiseProduct(moved).sum() / all, 0.0, 1.0) : 0;
  const double measured = pull.precision.sum() * unit * unit + pull.unmatched;  // how many
  if (!(measured > 0)) return;
  const double square = all + pull.unmatched * kWidest * kWidest;  // in units
  surprise_ = unit * std::sqrt(square / measured / 3);
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
