// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/spring_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "trainer/data/held_back.h"
#include "trainer/motion/observer.h"
#include "trainer/solvers/adam.h"
#include "trainer/solvers/gauss_newton.h"

namespace physpring {
namespace {

constexpr int kFirstSpringGain = 3;    // an index of kObserverGains
constexpr int kFollowedSteps = 3;      // steps of Gauss-Newton with each gain before the last ...
constexpr int kGaussNewtonSteps = 15;  // ... and with the last one
constexpr int kAdamSteps = 200;
constexpr int kPatience = 40;  // Adam ends after so many steps in a row that gain little
// The rate of log-stiffnesses; others move in proportion to their prior.
constexpr double kLearningRate = 0.03;
constexpr double kAstray = 1.5;  // Adam turns back where the mean square is so much above the best

// Parts of the work, as measured on recordings of 80 to 500 particles.
constexpr double kFollowed = 0.4, kGaussNewton = 0.6;

struct GaussNewtonFit {
  Eigen::VectorXd x;
  int gain = kFirstSpringGain;
  int iteration = 0;  // steps made with this gain
  int slow = 0;       // steps in a row that gained little
  double damping = 1e-3, mean_square = 0;

  template <class Visitor>
  void Visit(Visitor&& visit) {
    visit(x, gain, iteration, slow, damping, mean_square);
  }
};

struct AdamFit {
  Eigen::VectorXd x, best;
  Adam adam;
  int iteration = 0;
  int slow = 0;     // steps in a row that gained little
  double rate = 1;  // the learning rate, relative to the schedule
  double best_mean_square = kInfinity;
  double gained_mean_square = kInfinity;  // the best one when it last fell by more than little

  explicit AdamFit(const Eigen::VectorXd& start) : x(start), best(start), adam(start.size()) {}
  template <class Visitor>
  void Visit(Visitor&& visit) {
    visit(x, best, adam, iteration, slow, rate, best_mean_square, gained_mean_square);
  }
};

int AdamSteps(const TrainOptions& options) {
  if (options.optimizer == TrainOptions::Optimizer::kGaussNewton) return 0;
  return options.epochs > 0 ? options.epochs : kAdamSteps;
}

// What is fitted, and to what.
class SpringFit {
 public:
  SpringFit(const Parameters& parameters, const Body& body, const FitData& data,
            const TrainOptions& options)
      : options_(options),
        parameters_(parameters),
        prior_(SpringPrior(parameters_)),
        follow_(FollowOptions(data.recordings[0], body, options)),
        episodes_(FitEpisodes(data, kMostSpringRecordings)) {}

  StepReport StepGaussNewton(GaussNewtonFit* fit) const;
  StepReport StepAdam(AdamFit* fit) const;

 private:
  double PartOfGaussNewton(const GaussNewtonFit& fit) const;

  const TrainOptions& options_;
  const Parameters& parameters_;
  GaussNewtonOptions prior_;
  MotionProblem::Options follow_;
  std::vector<Episode> episodes_;
};

double SpringFit::PartOfGaussNewton(const GaussNewtonFit& fit) const {
  if (fit.gain == kLastGain) {
    const double part = static_cast<double>(fit.iteration) / GaussNewtonSteps(options_);
    return kFollowed + (1 - kFollowed) * part;
  }
  const double part = static_cast<double>(fit.iteration) / kFollowedSteps;
  return kFollowed * (fit.gain - kFirstSpringGain + part) / (kLastGain - kFirstSpringGain);
}

StepReport SpringFit::StepGaussNewton(GaussNewtonFit* fit) const {
  MotionProblem::Options follow = follow_;
  follow.rollout.growth_limit = kInfinity;
  follow.rollout.observer_gain = kObserverGains[fit->gain];
  MotionProblem problem(parameters_, episodes_, follow);
  const GaussNewtonState before{fit->x, fit->damping, fit->mean_square, false};
  const GaussNewtonState after = GaussNewtonStep(&problem, before, prior_);
  fit->x = after.x;
  fit->damping = after.damping;
  fit->mean_square = after.mean_square;
  const bool first_step = fit->iteration++ == 0;
  const bool stuck = IsStuck(before, after, first_step);
  const bool gained = first_step || after.mean_square < kSlowStep * before.mean_square;
  fit->slow = gained ? 0 : fit->slow + 1;
  StepReport report{false, PartOfGaussNewton(*fit),
                    fmt::format("single springs: root mean square {:.3f} mm",
                                PointMillimetres(after.mean_square))};
  const bool ends = stuck || fit->slow == kMostSlowSteps;
  if (fit->gain == kLastGain) {
    report.done = ends || fit->iteration >= GaussNewtonSteps(options_);
  } else if (ends || fit->iteration >= kFollowedSteps) {
    ++fit->gain;
    fit->iteration = fit->slow = 0;
    fit->damping = 1e-3;
  }
  return report;
}

// One iteration on |r|^2 / variance + prior, the variance being the current mean of r^2. Where it
// went astray it goes on from the best, half as fast and with a fresh momentum.
StepReport SpringFit::StepAdam(AdamFit* fit) const {
  MotionProblem problem(parameters_, episodes_, follow_);
  const auto r = problem.Linearise(fit->x);
  const double mean_square = r ? r->squaredNorm() / static_cast<double>(r->size()) : kInfinity;
  if (mean_square < fit->best_mean_square) {
    fit->best_mean_square = mean_square;
    fit->best = fit->x;
  }
  ++fit->slow;
  if (fit->best_mean_square < kSlowStep * fit->gained_mean_square) {
    fit->gained_mean_square = fit->best_mean_square;
    fit->slow = 0;
  }
  fit->adam.steps = fit->iteration;
  if (r && mean_square < kAstray * fit->best_mean_square) {
    const Eigen::VectorXd gradient =
        problem.JacobianTransposedTimes(*r) / mean_square + prior_.precision.cwiseProduct(fit->x);
    // steps in proportion to the prior's deviations, falling as a cosine
    const double part = static_cast<double>(fit->iteration) / AdamSteps(options_);
    const double rate = fit->rate * kLearningRate * 0.5 * (1 + std::cos(M_PI * part));
    const Eigen::VectorXd rates =
        rate * (2 * prior_.precision.cwiseSqrt().cwiseInverse()).cwiseMin(1);
    fit->adam.Step(gradient, rates, &fit->x);
  } else {
    fit->x = fit->best;
    fit->rate *= 0.5;
    fit->adam.mean.setZero();
  }
  ++fit->iteration;
  const bool stuck = fit->slow >= kPatience && options_.epochs == 0;
  return {fit->iteration >= AdamSteps(options_) || stuck,
          static_cast<double>(fit->iteration) / AdamSteps(options_),
          fmt::format("single springs: root mean square {:.3f} mm, best {:.3f}{}",
                      PointMillimetres(mean_square), PointMillimetres(fit->best_mean_square),
                      problem.cuts() > 0
                          ? fmt::format(" (adjoint cut into {} windows)", problem.cuts() + 1)
                          : "")};
}

}  // namespace

int GaussNewtonSteps(const TrainOptions& options) {
  switch (options.optimizer) {
    case TrainOptions::Optimizer::kAutomatic:
      return kGaussNewtonSteps;
    case TrainOptions::Optimizer::kGaussNewton:
      return options.epochs > 0 ? options.epochs : kGaussNewtonSteps;
    case TrainOptions::Optimizer::kAdam:
      return 0;
  }
  return 0;
}

Eigen::VectorXd FitSprings(const Parameters& parameters, const Body& body, const FitData& data,
                           const TrainOptions& options, const Eigen::VectorXd& x,
                           const Work& work) {
  const SpringFit springs(parameters, body, data, options);
  GaussNewtonFit fit{x};
  // where Gauss-Newton gains little early on, the residuals are too rough for it
  bool rough = true;
  if (GaussNewtonSteps(options) > 0) {
    fit = work.Part("single springs (Gauss-Newton)", 0, kGaussNewton)
              .Follow(fit, [&](GaussNewtonFit* one) { return springs.StepGaussNewton(one); });
    rough = fit.iteration < GaussNewtonSteps(options);
  }
  const bool asked = options.optimizer == TrainOptions::Optimizer::kAdam || options.epochs > 0;
  if (AdamSteps(options) == 0 || !(rough || asked)) return fit.x;
  return work.Part("single springs (Adam)", kGaussNewton, 1)
      .Follow(AdamFit(fit.x), [&](AdamFit* one) { return springs.StepAdam(one); })
      .best;
}

}  // namespace physpring
