// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/posterior_estimate.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "trainer/bodies/factors.h"
#include "trainer/bodies/smooth_body.h"
#include "trainer/motion/motion_problem.h"
#include "trainer/motion/residual_correlation.h"
#include "trainer/solvers/levenberg_marquardt.h"
#include "twin/effects/registry.h"

namespace physpring {
namespace {

constexpr int kRounds = 2;            // in which the secants' steps become as long as deviations
constexpr double kNegligible = 1e-3;  // what moves no value by more of itself is left out
// No direction of samples changes a logarithm by more: several together leave what is linear.
constexpr double kMostOfSamples = std::numbers::ln2;
const double kPriorDeviation = 1 / std::sqrt(kLevenbergMarquardtPrecision);  // of a logarithm

// The part of J^T r of each fitted frame: columns of J x frames, episode after episode.
std::vector<Eigen::MatrixXd> FrameScores(const std::vector<Episode>& episodes,
                                         const Eigen::MatrixXd& jacobian,
                                         const Eigen::VectorXd& r) {
  std::vector<Eigen::MatrixXd> scores;
  Eigen::Index row = 0;
  for (const Episode& episode : episodes) {
    Eigen::MatrixXd of_episode = Eigen::MatrixXd::Zero(jacobian.cols(), episode.frames);
    ForEachSeen(episode, FrameUse::kFit, [&](int frame, int /*point*/) {
      of_episode.col(frame) += jacobian.middleRows<3>(row).transpose() * r.segment<3>(row);
      row += 3;
    });
    scores.push_back(of_episode);
  }
  return scores;
}

// The covariance of the sum over frames, with Bartlett's weights for frames up to a quarter of all
// apart.
Eigen::MatrixXd LongRunCovariance(const std::vector<Eigen::MatrixXd>& scores) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(scores.at(0).rows(), scores[0].rows());
  for (const Eigen::MatrixXd& of_episode : scores) {
    const Eigen::Index frames = of_episode.cols(), reach = frames / 4;
    sum += of_episode * of_episode.transpose();
    for (Eigen::Index lag = 1; lag < reach; ++lag) {
      const double weight = 1 - static_cast<double>(lag) / static_cast<double>(reach);
      const Eigen::MatrixXd product =
          of_episode.rightCols(frames - lag) * of_episode.leftCols(frames - lag).transpose();
      sum += weight * (product + product.transpose());
    }
  }
  return sum;
}

// Columns d whose sum of d d^T is the covariance: its main axes, a standard deviation long.
Eigen::MatrixXd AxesOf(const Eigen::MatrixXd& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
}

// The least covariance that is in no direction below either of two; the first is regular.
Eigen::MatrixXd UpperBound(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::LLT<Eigen::MatrixXd> factor(a);
  const Eigen::MatrixXd half = factor.matrixL().solve(b);
  const Eigen::MatrixXd relative = factor.matrixL().solve(half.transpose());
  const Eigen::MatrixXd symmetric = 0.5 * (relative + relative.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(symmetric);
  const Eigen::MatrixXd axes = factor.matrixL() * eigen.eigenvectors() *
                               eigen.eigenvalues().cwiseMax(1).cwiseSqrt().asDiagonal();
  return axes * axes.transpose();
}

// What a step of one number does to the values that a posterior moves.
class Change {
 public:
  Change(const SpringMassSystem& from, const SpringMassSystem& to, double step)
      : from_(from), to_(to), step_(step) {}

  double Stiffness(int e) const { return LogRatio(from_.stiffness[e], to_.stiffness[e]); }
  double LossTime(int e) const { return LogRatio(from_.dashpot[e], to_.dashpot[e]) - Stiffness(e); }
  double Drag() const { return LogRatio(from_.drag, to_.drag); }
  double Contact(int c) const {
    const auto member = kContactCoefficients<double>[c].member;
    return LogRatio(from_.contact.surface.*member, to_.contact.surface.*member);
  }
  Eigen::VectorXd Effects() const {
    Eigen::VectorXd changes(EffectValueCount(from_.effects));
    Eigen::Index i = 0;
    for (std::size_t n = 0; n < from_.effects.size(); ++n) {
      const double* before = from_.effects[n].values.data();
      const double* after = to_.effects[n].values.data();
      for (const EffectParameter& parameter : GetEffect(from_.effects[n].name).parameters()) {
        const bool logarithmic = parameter.spacing == EffectParameter::Spacing::kLogarithmic;
        for (int k = 0; k < parameter.count; ++k, ++before, ++after) {
          changes[i++] = logarithmic ? LogRatio(*before, *after) : (*after - *before) / step_;
        }
      }
    }
    return changes;
  }

 private:
  // 0 for values of 0, which no factor moves.
  double LogRatio(double before, double after) const {
    return before > 0 && after > 0 ? std::log(after / before) / step_ : 0;
  }

  const SpringMassSystem &from_, &to_;
  double step_;
};

// What a unit of each number changes.
Posterior Slopes(const Parameters& numbers, const SpringMassSystem& system) {
  constexpr double kStep = 1e-4;
  const int size = numbers.size(), springs = system.spring_count();
  Posterior slopes{Eigen::MatrixXd(size, springs), Eigen::MatrixXd(size, springs),
                   Eigen::VectorXd(size), Eigen::MatrixXd(size, kContactCount),
                   Eigen::MatrixXd(size, EffectValueCount(system.effects))};
  for (int i = 0; i < size; ++i) {
    const SpringMassSystem moved = numbers.Apply(kStep * Eigen::VectorXd::Unit(size, i));
    const Change change(system, moved, kStep);
    for (int e = 0; e < springs; ++e) {
      slopes.stiffness(i, e) = change.Stiffness(e);
      slopes.loss_time(i, e) = change.LossTime(e);
    }
    slopes.drag[i] = change.Drag();
    for (int c = 0; c < kContactCount; ++c) slopes.contact(i, c) = change.Contact(c);
    slopes.effects.row(i) = change.Effects();
  }
  return slopes;
}

// What steps of the numbers change.
Posterior Along(const Eigen::MatrixXd& steps, const Posterior& slopes) {
  const Eigen::MatrixXd along = steps.transpose();
  return {along * slopes.stiffness, along * slopes.loss_time, along * slopes.drag,
          along * slopes.contact, along * slopes.effects};
}

// The largest change of a logarithm along direction `i`.
double LargestChange(const Posterior& posterior, int i) {
  const auto stiffness = posterior.stiffness.row(i), loss_time = posterior.loss_time.row(i);
  return std::max({stiffness.cwiseAbs().maxCoeff(), (stiffness + loss_time).cwiseAbs().maxCoeff(),
                   std::abs(posterior.drag[i]), posterior.contact.row(i).cwiseAbs().maxCoeff()});
}

// The posterior of numbers of this covariance. Its directions are shorter where they would change a
// logarithm by more than `most`; those that change next to nothing are left out.
Posterior PosteriorOf(const Eigen::MatrixXd& covariance, const Posterior& slopes, double most) {
  Eigen::MatrixXd axes = AxesOf(covariance);
  const Posterior changes = Along(axes, slopes);
  std::vector<int> kept;
  for (int i = 0; i < axes.cols(); ++i) {
    const double change = LargestChange(changes, i);
    axes.col(i) *= std::min(1.0, most / std::max(1e-300, change));
    if (change >= kNegligible || (changes.effects.row(i).array() != 0).any()) kept.push_back(i);
  }
  return Along(axes(Eigen::all, kept), slopes);
}

// The deviation of the stiffness of a spring, a logarithm: the median of all.
double MedianDeviation(const Posterior& posterior) {
  Eigen::VectorXd variances = posterior.stiffness.colwise().squaredNorm().transpose();
  double* const middle = variances.data() + variances.size() / 2;
  std::nth_element(variances.data(), middle, variances.data() + variances.size());
  return std::sqrt(*middle);
}

// Covariances of the numbers, after so many rounds.
struct Covariances {
  Eigen::MatrixXd independent, bound;  // H^-1, and the upper bound of both
  int rounds = 0;

  template <class Visitor>
  void Visit(Visitor&& visit) {
    visit(independent, bound, rounds);
  }
};

class Estimator {
 public:
  Estimator(const SpringMassSystem& system, const Body& body, const Parameters& numbers,
            const Posterior& slopes, const std::vector<Episode>& episodes,
            const TrainOptions& options)
      : system_(system),
        body_(body),
        numbers_(numbers),
        slopes_(slopes),
        episodes_(episodes),
        options_(options) {}

  // One round of secants: in the first their steps are short.
  StepReport Step(Covariances* covariances) const;

 private:
  MotionProblem Problem(bool keep_substeps) const;
  Eigen::MatrixXd StepsAfter(const Covariances& covariances) const;
  // How the residuals r change along each column of `steps`, on the side where they change more; 0,
  // which tells nothing, where neither side can be evaluated.
  Eigen::MatrixXd Secants(const MotionProblem& problem, const Eigen::MatrixXd& steps,
                          const Eigen::VectorXd& r) const;

  const SpringMassSystem& system_;
  const Body& body_;
  const Parameters& numbers_;
  const Posterior& slopes_;
  const std::vector<Episode>& episodes_;
  const TrainOptions& options_;
};

MotionProblem Estimator::Problem(bool keep_substeps) const {
  MotionProblem::Options follow = FollowOptions(*episodes_[0].recording, body_, options_);
  follow.threads = 1;  // the differences run in parallel
  follow.keep_substeps = keep_substeps;
  return {SystemMap::OfResiduals([this](const Eigen::VectorXd& x) { return numbers_.Apply(x); }),
          episodes_, follow};
}

Eigen::MatrixXd Estimator::StepsAfter(const Covariances& covariances) const {
  if (covariances.rounds == 0) {
    return FactorDifference(*episodes_[0].recording) *
           Eigen::MatrixXd::Identity(numbers_.size(), numbers_.size());
  }
  Eigen::MatrixXd steps = AxesOf(covariances.independent);
  for (auto one : steps.colwise()) {
    one *= std::min(1.0, kPriorDeviation / std::max(1e-300, one.cwiseAbs().maxCoeff()));
  }
  return steps;
}

Eigen::MatrixXd Estimator::Secants(const MotionProblem& problem, const Eigen::MatrixXd& steps,
                                   const Eigen::VectorXd& r) const {
  constexpr Eigen::Index kAtOnce = 16;  // residuals of all steps at once would take much memory
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(r.size(), steps.cols());
  for (Eigen::Index first = 0; first < steps.cols(); first += kAtOnce) {
    const Eigen::Index count = std::min(kAtOnce, steps.cols() - first);
    std::vector<Eigen::VectorXd> xs;
    for (const double side : {1, -1}) {
      for (Eigen::Index i = 0; i < count; ++i) xs.emplace_back(side * steps.col(first + i));
    }
    const auto residuals = EvaluateAll(ResidualsOf(problem), xs, options_.threads);
    for (Eigen::Index i = 0; i < count; ++i) {
      auto column = columns.col(first + i);
      const auto& ahead = residuals[static_cast<std::size_t>(i)];
      const auto& behind = residuals[static_cast<std::size_t>(count + i)];
      if (ahead) column = *ahead - r;
      if (behind && (r - *behind).squaredNorm() > column.squaredNorm()) column = r - *behind;
    }
  }
  return columns;
}

StepReport Estimator::Step(Covariances* covariances) const {
  const int size = numbers_.size();
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(size, size);
  // near the fit, a sub-step more or less would look like a slope
  MotionProblem problem = Problem(covariances->rounds == 0);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(size);
  const auto r = problem.FixSubsteps(none) ? problem.Residuals(none) : std::nullopt;
  if (!r || r->size() == 0) {
    covariances->independent = covariances->bound = identity / kLevenbergMarquardtPrecision;
    return {true, 1, "posterior: that of the prior"};
  }
  const double count = static_cast<double>(r->size());
  const double correlation = ResidualCorrelation(
      system_, episodes_, FollowOptions(*episodes_[0].recording, body_, options_).rollout);
  const double inflation = 1 + std::max(0.0, correlation) * count / size;
  const double variance = inflation * std::max(r->squaredNorm() / count, 1e-300);

  // in coordinates z, the numbers being steps z
  const Eigen::MatrixXd steps = StepsAfter(*covariances);
  const Eigen::MatrixXd jacobian = Secants(problem, steps, *r);
  const Eigen::MatrixXd precision = jacobian.transpose() * jacobian / variance +
                                    kLevenbergMarquardtPrecision * (steps.transpose() * steps);
  const Eigen::MatrixXd inverse = precision.ldlt().solve(identity);
  const Eigen::MatrixXd scores =
      LongRunCovariance(FrameScores(episodes_, jacobian, *r)) * (inflation / (variance * variance));
  covariances->independent = steps * inverse * steps.transpose();
  covariances->bound =
      UpperBound(covariances->independent, steps * inverse * scores * inverse * steps.transpose());
  ++covariances->rounds;
  const Posterior posterior = PosteriorOf(covariances->independent, slopes_, kMostOfSamples);
  return {covariances->rounds > kRounds, static_cast<double>(covariances->rounds) / (kRounds + 1),
          fmt::format("posterior: half of the stiffnesses are known to within {:.2g} %",
                      100 * MedianDeviation(posterior))};
}

}  // namespace

EstimatedPosterior EstimatePosterior(const SpringMassSystem& system, const Body& body,
                                     const std::vector<Episode>& episodes,
                                     const TrainOptions& options, const Work& work) {
  const Parameters numbers =
      SmoothBody(system, OnlyFitFrames(episodes.at(0)), *body.kind, {1, true}).factors();
  const Posterior slopes = Slopes(numbers, system);
  const Estimator estimator(system, body, numbers, slopes, episodes, options);
  const Covariances found =
      work.Follow(Covariances{}, [&](Covariances* one) { return estimator.Step(one); });
  return {PosteriorOf(found.independent, slopes, kMostOfSamples),
          PosteriorOf(found.bound, slopes, kPriorDeviation)};
}

}  // namespace physpring
