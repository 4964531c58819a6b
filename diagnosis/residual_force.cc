// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/residual_force.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <utility>

#include "trainer/motion/rollout.h"
#include "twin/error.h"
#include "twin/uniform.h"

namespace physpring {
namespace {

// The observer's gains. The first under which forces can be found is taken. Motions that part
// quickly (a body that slips) need more, and show smaller forces.
constexpr std::array<double, 3> kResidualGains = {0.35, 0.6, 0.85};
// The most linearisations, and the most steps of conjugate gradients in each.
constexpr int kLinearisations = 3, kKickSteps = 12;
// The mean square that is small enough, times the variance of the measurements.
constexpr double kEnough = 1.05;
// The search has converged if it leaves less than so many deviations, or less than this part.
constexpr double kNearNoise = 3, kExplainedPart = 0.5;
// A linearisation that leaves more than this part of the square is the last one.
constexpr double kGainsEnough = 0.999;

// The problem of finding kicks, as one vector: 3 x nodes for each frame but the last.
class KickProblem {
 public:
  KickProblem(const SpringMassSystem& system, const Recording& recording,
              const ResidualForceOptions& options, double gain)
      : system_(system), recording_(recording), options_(options), gain_(gain), frames_(0) {
    for (int t = 1; t < recording.frame_count(); ++t) {
      for (int i = 0; i < recording.point_count(); ++i) {
        if (std::isnan(recording.points[Index(t)](0, i))) continue;
        seen_.emplace_back(t, i);
        frames_ = t + 1;
      }
    }
  }

  Eigen::Index size() const { return 3 * system_.node_count() * (frames_ - 1); }
  Eigen::Index rows() const { return 3 * static_cast<Eigen::Index>(seen_.size()); }
  const Rollout& rollout() const { return *rollout_; }
  std::vector<Points> Unpack(const Eigen::VectorXd& x) const {
    std::vector<Points> kicks;
    const Eigen::Index each = 3 * system_.node_count();
    for (int t = 0; t + 1 < frames_; ++t) {
      kicks.emplace_back(x.segment(t * each, each).reshaped(3, system_.node_count()));
    }
    return kicks;
  }

  // Measured minus predicted coordinates; the rollout is kept for the adjoint. Nothing if the
  // motion diverges.
  std::optional<Eigen::VectorXd> Linearise(const Eigen::VectorXd& x) {
    x_ = x;
    kicks_ = Unpack(x);
    rollout_ = Run(kicks_);
    if (rollout_->diverged()) return {};
    r_ = Residuals(*rollout_);
    return r_;
  }
  std::optional<Eigen::VectorXd> At(const Eigen::VectorXd& x) const {
    const std::vector<Points> kicks = Unpack(x);
    const auto rollout = Run(kicks);
    if (rollout->diverged()) return {};
    return Residuals(*rollout);
  }
  Eigen::VectorXd JacobianTimes(const Eigen::VectorXd& v) const {
    const double step = options_.difference / std::max(1e-300, v.cwiseAbs().maxCoeff());
    const auto moved = At(x_ + step * v);
    if (!moved) return Eigen::VectorXd::Zero(rows());
    return (r_ - *moved) / step;
  }
  Eigen::VectorXd JacobianTransposedTimes(const Eigen::VectorXd& u) const {
    std::vector<Points> bars(Index(frames_));
    for (Points& bar : bars) bar.setZero(3, system_.node_count());
    for (std::size_t n = 0; n < seen_.size(); ++n) {
      bars[Index(seen_[n].first)].col(seen_[n].second) =
          u.segment<3>(3 * static_cast<Eigen::Index>(n));
    }
    const RolloutAdjoint adjoint = rollout_->Adjoint(bars);
    Eigen::VectorXd x_bar(size());
    const Eigen::Index each = 3 * system_.node_count();
    for (int t = 0; t + 1 < frames_; ++t) {
      x_bar.segment(t * each, each) = adjoint.kicks_bar[Index(t)].reshaped();
    }
    return x_bar;
  }

 private:
  static std::size_t Index(int i) { return static_cast<std::size_t>(i); }
  std::unique_ptr<Rollout> Run(const std::vector<Points>& kicks) const {
    RolloutOptions options;
    options.controller_velocity = options_.controller_velocity;
    options.substeps = options_.substeps;
    options.growth_limit = std::numeric_limits<double>::infinity();
    options.observer_gain = gain_;
    options.kicks = &kicks;
    return RollOut(system_, {&recording_, frames_}, options);
  }
  Eigen::VectorXd Residuals(const Rollout& rollout) const {
    Eigen::VectorXd r(rows());
    for (std::size_t n = 0; n < seen_.size(); ++n) {
      const auto& [frame, point] = seen_[n];
      r.segment<3>(3 * static_cast<Eigen::Index>(n)) =
          recording_.points[Index(frame)].col(point) - rollout.positions()[Index(frame)].col(point);
    }
    return r;
  }

  const SpringMassSystem& system_;
  const Recording& recording_;
  ResidualForceOptions options_;
  double gain_;  // the observer's gain
  int frames_;   // how many, up to the last one in which something is seen
  std::vector<std::pair<int, int>> seen_;  // frame, point
  // the point of linearisation
  std::vector<Points> kicks_;
  std::unique_ptr<Rollout> rollout_;
  Eigen::VectorXd x_, r_;
};

// CGLS from zero: the step s with J s near r, until |r - J s|^2 is at most `target`. Counts the
// steps taken.
Eigen::VectorXd Cgls(const KickProblem& problem, const Eigen::VectorXd& r, double target, int most,
                     int* steps) {
  Eigen::VectorXd s = Eigen::VectorXd::Zero(problem.size()), left = r;
  Eigen::VectorXd gradient = problem.JacobianTransposedTimes(left), p = gradient;
  double squared = gradient.squaredNorm();
  for (int i = 0; i < most && left.squaredNorm() > target && squared > 0; ++i) {
    const Eigen::VectorXd q = problem.JacobianTimes(p);
    if (!(q.squaredNorm() > 0)) break;
    const double alpha = squared / q.squaredNorm();
    s += alpha * p;
    left -= alpha * q;
    gradient = problem.JacobianTransposedTimes(left);
    const double next = gradient.squaredNorm();
    p = gradient + next / squared * p;
    squared = next;
    ++*steps;
  }
  return s;
}

Eigen::VectorXd NormalNoise(Eigen::Index count, double deviation) {
  std::mt19937_64 generator(1);
  Eigen::VectorXd noise(count);
  for (double& value : noise) value = deviation * Normal(&generator);
  return noise;
}

// The residual forces under an observer of this gain; nothing if the motion diverges, or,
// `unless_useless`, if the first linearisation does not lead to smaller residuals.
std::optional<ResidualForce> FindUnder(double gain, bool unless_useless,
                                       const SpringMassSystem& system, const Recording& recording,
                                       const ResidualForceOptions& options) {
  KickProblem problem(system, recording, options, gain);
  const int nodes = system.node_count();
  if (problem.rows() == 0) {
    return ResidualForce{{}, {recording.start.leftCols(nodes)}, Eigen::VectorXd::Zero(nodes), 0};
  }
  Eigen::VectorXd x = Eigen::VectorXd::Zero(problem.size());
  auto r = problem.Linearise(x);
  if (!r) return {};
  const double first = r->squaredNorm();
  const double target =
      kEnough * options.deviation * options.deviation * static_cast<double>(problem.rows());
  int steps = 0;
  for (int i = 0; i < kLinearisations && r->squaredNorm() > target; ++i) {
    const double before = r->squaredNorm();
    const Eigen::VectorXd step = Cgls(problem, *r, target, kKickSteps, &steps);
    bool better = false;
    for (double length : {1.0, 0.4, 0.1}) {
      const auto trial = problem.At(x + length * step);
      if (!trial || trial->squaredNorm() >= before) continue;
      x += length * step;
      better = true;
      break;
    }
    if (!better && i == 0 && unless_useless) return {};
    if (!better) break;
    r = problem.Linearise(x);
    if (r->squaredNorm() > kGainsEnough * before) break;
  }

  ResidualForce result;
  const double fps = recording.fps;
  const Eigen::VectorXd mass = system.mass.head(nodes);
  result.position = problem.rollout().positions();
  result.left = std::sqrt(r->squaredNorm() / static_cast<double>(r->size()));
  result.converged = result.left <= kNearNoise * options.deviation ||
                     r->squaredNorm() <= kExplainedPart * kExplainedPart * first;
  for (const Points& kick : problem.Unpack(x)) {
    result.force.emplace_back(fps * (kick.array().rowwise() * mass.transpose().array()).matrix());
  }
  // the same from noise alone, in as many steps
  int again = 0;
  const Eigen::VectorXd of_noise =
      Cgls(problem, NormalNoise(problem.rows(), options.deviation), 0, steps, &again);
  Eigen::VectorXd squared = Eigen::VectorXd::Zero(nodes);
  for (const Points& kick : problem.Unpack(of_noise)) {
    squared += kick.colwise().squaredNorm().transpose();
  }
  const double values = 3 * static_cast<double>(result.force.size());
  result.noise = fps * mass.cwiseProduct((squared / values).cwiseSqrt());
  return result;
}

}  // namespace

ResidualForce FindResidualForce(const SpringMassSystem& system, const Recording& recording,
                                const ResidualForceOptions& options) {
  for (double gain : kResidualGains) {
    const bool last = gain == kResidualGains.back();
    if (auto found = FindUnder(gain, !last, system, recording, options)) return *std::move(found);
  }
  throw Error(fmt::format("recording {}: the motion diverges without forces", recording.name));
}

}  // namespace physpring
