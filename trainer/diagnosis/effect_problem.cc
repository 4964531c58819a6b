// SPDX-License-Identifier: Apache-2.0
#include "trainer/diagnosis/effect_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trainer/parallel.h"

namespace physpring {
namespace {

using Use = SplitRecording::Use;

// Sub-step as a part of the largest stable one, at most, where the number of sub-steps is given.
constexpr double kLargestSafety = 0.95;

// Calls visit(frame, point) for everything seen in frames of that use, in a fixed order.
template <class Visit>
void ForEachSeen(const SplitRecording& split, Use use, Visit visit) {
  for (int frame = 1; frame < split.last(use); ++frame) {
    if (split.use[static_cast<std::size_t>(frame)] != use) continue;
    const Points& measured = split.recording->points[static_cast<std::size_t>(frame)];
    for (int i = 0; i < measured.cols(); ++i) {
      if (!std::isnan(measured(0, i))) visit(frame, i);
    }
  }
}

}  // namespace

int DiagnosisRate(const SpringMassSystem& system, double fps) {
  const int substeps = StableSubsteps(ComputeStabilityBound(system), 1 / fps, kStepSafety);
  return static_cast<int>(std::ceil(std::max(substeps * fps, kLeastDiagnosisRate)));
}

EffectProblem::EffectProblem(EffectModel model, const std::vector<SplitRecording>& recordings,
                             const Options& options)
    : model_(std::move(model)),
      recordings_(recordings),
      options_(options),
      shortest_step_(1 / options.most_rate),
      substeps_(recordings.size(), 1),
      offset_{0} {
  for (const SplitRecording& split : recordings_) {
    const double fps = split.recording->fps;
    shortest_step_ = std::max(shortest_step_, 1 / (std::floor(options.most_rate / fps) * fps));
    std::size_t seen = 0;
    ForEachSeen(split, Use::kFit, [&](int, int) { ++seen; });
    offset_.push_back(offset_.back() + 3 * seen);
  }
}

SpringMassSystem EffectProblem::SystemAt(const Eigen::VectorXd& x) const {
  SpringMassSystem system = model_.Apply(x);
  if (options_.limit_dashpots) LimitDashpots(shortest_step_ / options_.safety, &system);
  return system;
}

bool EffectProblem::FixSubsteps(const Eigen::VectorXd& x) {
  const StabilityBound bound = ComputeStabilityBound(SystemAt(x));
  for (std::size_t i = 0; i < recordings_.size(); ++i) {
    const double fps = recordings_[i].recording->fps;
    substeps_[i] = StableSubsteps(bound, 1 / fps, options_.safety);
    if (substeps_[i] * fps > options_.most_rate) return false;
    substeps_[i] = std::max(substeps_[i], static_cast<int>(std::ceil(options_.least_rate / fps)));
  }
  return true;
}

std::optional<Eigen::VectorXd> EffectProblem::RollOutAll(
    const SpringMassSystem& system, bool fit_only,
    std::vector<std::unique_ptr<Rollout>>* rollouts) const {
  Eigen::VectorXd residuals(offset_.back());
  std::vector<char> diverged(recordings_.size(), 0);
  if (rollouts) rollouts->resize(recordings_.size());
  ParallelFor(static_cast<int>(recordings_.size()), options_.threads, [&](int i) {
    const SplitRecording& split = recordings_[i];
    const int fit = split.last(Use::kFit);
    const int frames = fit_only ? fit : std::max(fit, split.last(Use::kHeld));
    if (frames < 2) return;
    RolloutOptions rollout_options;
    rollout_options.controller_velocity = options_.controller_velocity;
    rollout_options.substeps = substeps_[i];
    rollout_options.single_precision = options_.single_precision;
    rollout_options.growth_limit = std::numeric_limits<double>::infinity();
    rollout_options.observer_gain = options_.observer_gain;
    auto rollout = RollOut(system, {split.recording, frames}, rollout_options);
    diverged[i] = rollout->diverged();
    if (diverged[i]) return;
    std::size_t row = offset_[i];
    ForEachSeen(split, Use::kFit, [&](int frame, int point) {
      residuals.segment<3>(row) =
          rollout->positions()[frame].col(point) - split.recording->points[frame].col(point);
      row += 3;
    });
    if (rollouts) (*rollouts)[i] = std::move(rollout);
  });
  if (std::any_of(diverged.begin(), diverged.end(), [](char d) { return d != 0; })) return {};
  return residuals;
}

bool EffectProblem::IsStable(const SpringMassSystem& system) const {
  const StabilityBound bound = ComputeStabilityBound(system);
  for (std::size_t i = 0; i < recordings_.size(); ++i) {
    const double fps = recordings_[i].recording->fps;
    if (StableSubsteps(bound, 1 / fps, kLargestSafety) > substeps_[i]) return false;
    if (StableSubsteps(bound, 1 / fps, options_.safety) * fps > options_.most_rate) return false;
  }
  return true;
}

std::optional<Eigen::VectorXd> EffectProblem::Residuals(const Eigen::VectorXd& x) {
  const SpringMassSystem system = SystemAt(x);
  if (!IsStable(system)) return {};
  return RollOutAll(system, true, nullptr);
}

std::optional<Eigen::VectorXd> EffectProblem::Linearise(const Eigen::VectorXd& x) {
  if (!FixSubsteps(x)) return {};
  x_ = x;
  auto residuals = RollOutAll(SystemAt(x), true, &rollouts_);
  if (residuals) r_ = *residuals;
  return residuals;
}

Eigen::VectorXd EffectProblem::JacobianTimes(const Eigen::VectorXd& v) {
  const double step = options_.difference / std::max(1e-300, v.cwiseAbs().maxCoeff());
  const auto moved = RollOutAll(SystemAt(x_ + step * v), true, nullptr);
  if (!moved) return Eigen::VectorXd::Zero(r_.size());
  return (*moved - r_) / step;
}

Eigen::VectorXd EffectProblem::JacobianTransposedTimes(const Eigen::VectorXd& u) {
  const SpringMassSystem system = model_.Apply(x_);
  std::vector<std::optional<RolloutAdjoint>> adjoints(recordings_.size());
  ParallelFor(static_cast<int>(recordings_.size()), options_.threads, [&](int i) {
    if (!rollouts_[i]) return;
    std::vector<Points> bars(rollouts_[i]->positions().size());
    for (Points& bar : bars) bar.setZero(3, system.node_count());
    std::size_t row = offset_[i];
    ForEachSeen(recordings_[i], Use::kFit, [&](int frame, int point) {
      bars[frame].col(point) = u.segment<3>(row);
      row += 3;
    });
    adjoints[i] = rollouts_[i]->Adjoint(bars);
  });
  SystemGradient sum(system);
  for (const auto& adjoint : adjoints) {
    if (adjoint) sum += adjoint->gradient;
  }
  return model_.Adjoint(x_, system, sum);
}

std::optional<std::vector<std::vector<Points>>> EffectProblem::Predict(
    const Eigen::VectorXd& x) const {
  std::vector<std::unique_ptr<Rollout>> rollouts;
  if (!RollOutAll(SystemAt(x), false, &rollouts)) return {};
  std::vector<std::vector<Points>> predicted;
  for (const auto& rollout : rollouts) {
    predicted.push_back(rollout ? rollout->positions() : std::vector<Points>());
  }
  return predicted;
}

FrameTrack TrackOf(const std::vector<SplitRecording>& recordings,
                   const std::vector<std::vector<Points>>& predicted, Use use) {
  FrameTrack track;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    std::vector<double> sum(recordings[i].use.size(), 0), seen(sum);
    ForEachSeen(recordings[i], use, [&](int frame, int point) {
      sum[frame] +=
          (predicted[i][frame].col(point) - recordings[i].recording->points[frame].col(point))
              .norm();
      seen[frame] += 1;
    });
    for (std::size_t frame = 0; frame < sum.size(); ++frame) {
      if (seen[frame] > 0) track.push_back(sum[frame] / seen[frame]);
    }
  }
  return track;
}

double Mean(const FrameTrack& track) {
  double sum = 0;
  for (double error : track) sum += error;
  return track.empty() ? std::numeric_limits<double>::quiet_NaN()
                       : sum / static_cast<double>(track.size());
}

}  // namespace physpring
