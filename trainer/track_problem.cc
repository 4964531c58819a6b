// SPDX-License-Identifier: Apache-2.0
#include "trainer/track_problem.h"

#include <algorithm>
#include <cmath>

#include "trainer/parallel.h"

namespace physpring {
namespace {

// Calls visit(frame, point) for everything seen in frames 1 .. frames - 1, in a fixed order.
template <class Visit>
void ForEachSeen(const Episode& episode, Visit visit) {
  for (int frame = 1; frame < episode.frames; ++frame) {
    const Points& measured = episode.recording->points[frame];
    for (int i = 0; i < measured.cols(); ++i) {
      if (!std::isnan(measured(0, i))) visit(frame, i);
    }
  }
}

}  // namespace

TrackProblem::TrackProblem(const Parameters& parameters, std::vector<Episode> episodes,
                           const Options& options)
    : parameters_(parameters), episodes_(std::move(episodes)), options_(options), offset_{0} {
  for (const Episode& episode : episodes_) {
    std::size_t seen = 0;
    ForEachSeen(episode, [&](int, int) { ++seen; });
    offset_.push_back(offset_.back() + 3 * seen);
  }
}

int TrackProblem::Substeps(const SpringMassSystem& system) const {
  if (options_.rollout.substeps > 0) return options_.rollout.substeps;
  const StabilityBound bound = ComputeStabilityBound(system);
  int substeps = 1;
  for (const Episode& episode : episodes_) {
    substeps =
        std::max(substeps, StableSubsteps(bound, 1 / episode.recording->fps, options_.safety));
  }
  return substeps > options_.most_substeps ? 0 : substeps;
}

std::optional<Eigen::VectorXd> TrackProblem::RollOutAll(
    const Eigen::VectorXd& x, int substeps, std::vector<std::unique_ptr<Rollout>>* rollouts) const {
  if (substeps == 0) return {};
  const SpringMassSystem system = parameters_.Apply(x);
  RolloutOptions options = options_.rollout;
  options.substeps = substeps;
  options.threads = episodes_.size() == 1 ? options_.threads : 1;
  Eigen::VectorXd residuals(offset_.back());
  std::vector<char> diverged(episodes_.size(), 0);
  if (rollouts) rollouts->resize(episodes_.size());
  ParallelFor(static_cast<int>(episodes_.size()), options_.threads, [&](int i) {
    const Episode& episode = episodes_[i];
    auto rollout = RollOut(system, episode, options);
    diverged[i] = rollout->diverged();
    if (diverged[i]) return;
    std::size_t row = offset_[i];
    ForEachSeen(episode, [&](int frame, int point) {
      residuals.segment<3>(row) =
          rollout->positions()[frame].col(point) - episode.recording->points[frame].col(point);
      row += 3;
    });
    if (rollouts) (*rollouts)[i] = std::move(rollout);
  });
  if (std::any_of(diverged.begin(), diverged.end(), [](char d) { return d != 0; })) return {};
  return residuals;
}

std::optional<Eigen::VectorXd> TrackProblem::Residuals(const Eigen::VectorXd& x) {
  return RollOutAll(x, Substeps(parameters_.Apply(x)), nullptr);
}

std::optional<Eigen::VectorXd> TrackProblem::Linearise(const Eigen::VectorXd& x) {
  x_ = x;
  system_ = parameters_.Apply(x);
  substeps_ = Substeps(system_);
  auto residuals = RollOutAll(x, substeps_, &rollouts_);
  if (residuals) r_ = *residuals;
  return residuals;
}

Eigen::VectorXd TrackProblem::JacobianTimes(const Eigen::VectorXd& v) {
  const double step = options_.difference / std::max(1e-300, v.cwiseAbs().maxCoeff());
  const auto moved = RollOutAll(x_ + step * v, substeps_, nullptr);
  if (!moved) return Eigen::VectorXd::Zero(r_.size());
  return (*moved - r_) / step;
}

Eigen::VectorXd TrackProblem::JacobianTransposedTimes(const Eigen::VectorXd& u) {
  std::vector<std::optional<RolloutAdjoint>> adjoints(episodes_.size());
  ParallelFor(static_cast<int>(episodes_.size()), options_.threads, [&](int i) {
    const Episode& episode = episodes_[i];
    const Eigen::Index nodes = rollouts_[i]->positions()[0].cols();
    std::vector<Points> bars(episode.frames);
    for (Points& bar : bars) bar.setZero(3, nodes);
    std::size_t row = offset_[i];
    ForEachSeen(episode, [&](int frame, int point) {
      bars[frame].col(point) = u.segment<3>(row);
      row += 3;
    });
    adjoints[i] = rollouts_[i]->Adjoint(bars);
  });
  SystemGradient sum(system_);
  cuts_ = 0;
  for (const auto& adjoint : adjoints) {
    sum += adjoint->gradient;
    cuts_ += adjoint->cuts;
  }
  return parameters_.Adjoint(x_, system_, sum);
}

}  // namespace physpring
