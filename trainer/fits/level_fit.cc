// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/level_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "trainer/bodies/factors.h"
#include "trainer/fits/level_model.h"
#include "trainer/motion/lifted_loss.h"
#include "trainer/motion/motion_problem.h"
#include "trainer/motion/observer.h"
#include "trainer/network/corrections_fit.h"
#include "trainer/network/level_network.h"
#include "trainer/solvers/levenberg_marquardt.h"
#include "twin/error.h"
#include "twin/parallel.h"

namespace physpring {
namespace {

constexpr int kMostLevelRecordings = 4;  // common factors are fitted to no more than these
constexpr int kFirstGain = 1;  // an index of kObserverGains: a Galerkin projection is not far off
constexpr int kLevelStepsPerGain = 4;
constexpr double kFirstLevelDamping = 1e-2;  // the damping with which each gain begins
constexpr int kLevelGaussNewtonSteps = 6;
constexpr int kLevelConjugateGradients = 12;
// Parts of the work.
constexpr double kTrialsDone = 0.15, kCommonDone = 0.3, kNetworkDone = 0.45;

struct CommonFit {
  Eigen::VectorXd common;
  int gain;           // an index of kObserverGains
  int iteration = 0;  // steps made with this gain
  double damping = kFirstLevelDamping;
  double mean_square = 0;  // the residuals' mean square, m^2; infinite where the level diverges

  template <class Visitor>
  void Visit(Visitor&& visit) {
    visit(common, gain, iteration, damping, mean_square);
  }
};

StepReport StepCommon(const LevelModel& model, int threads, int last_gain, CommonFit* fit) {
  const Parameters parameters = model.CommonParameters();
  // the differences run in parallel
  MotionProblem problem(parameters,
                        model.Motion(1, kObserverGains[fit->gain], kMostLevelRecordings), 0);
  LevenbergMarquardtOptions options;
  options.threads = threads;
  options.difference = FactorDifference(model.first());
  LevenbergMarquardtState state{fit->common, fit->damping, fit->mean_square, false};
  state = LevenbergMarquardtStep(ResidualsOf(problem), state, options);
  fit->common = state.x;
  fit->damping = state.damping;
  fit->mean_square = state.mean_square > 0 ? state.mean_square : kInfinity;
  ++fit->iteration;
  StepReport report{false,
                    static_cast<double>(fit->gain - kFirstGain) / (kLastGain - kFirstGain + 1),
                    fmt::format("level {}, common factors: {:.3f} mm", model.level(),
                                PointMillimetres(fit->mean_square))};
  if (fit->iteration < kLevelStepsPerGain && !state.converged) return report;
  fit->iteration = 0;
  fit->damping = kFirstLevelDamping;
  report.done = ++fit->gain > last_gain;
  return report;
}

// Fits the common factors under all gains but the last. Candidates are judged by this fit.
CommonFit TryCommonFactors(const LevelModel& model, const std::function<int()>& threads,
                           const Work& work) {
  const CommonFit start{Eigen::VectorXd::Zero(model.CommonParameters().size()), kFirstGain};
  return work.Follow(
      start, [&](CommonFit* fit) { return StepCommon(model, threads(), kLastGain - 1, fit); });
}

// The index of the best candidate. `fits` are those of the candidates.
std::size_t BestOf(const std::vector<CommonFit>& fits) {
  return static_cast<std::size_t>(
      std::min_element(fits.begin(), fits.end(),
                       [](const auto& a, const auto& b) { return a.mean_square < b.mean_square; }) -
      fits.begin());
}

// One update of the network's weights, or of the contact's coefficients, by the loss of the fit
// frames that are not held back.
StepReport StepNetwork(const LevelModel& model, const Eigen::VectorXd& common,
                       CorrectionsFit* fit) {
  const LevelNetwork network(model.network(), model.twin(),
                             model.NetworkBase({common, {}, fit->contact()}), fit->weights());
  const SpringMassSystem& system = network.corrected();
  const double score = model.HeldBackError(system);
  StepReport report{
      !fit->Judge(score), fit->Progress(),
      fmt::format("level {}, network: {:.3f} mm on held-back frames", model.level(), 1e3 * score)};
  if (report.done) return report;
  const std::optional<LiftedLoss> loss = ComputeLiftedLoss(model.MotionNotHeldBack(), system);
  if (!loss) {
    fit->TurnBack();
  } else if (fit->is_turn_of_weights()) {
    fit->Update(network.Adjoint(loss->gradient));
  } else {
    // derivatives with respect to the network's corrections: the contact's values add to the same
    // logits
    Features springs_bar, system_bar;
    CorrectionsAdjoint(system, loss->gradient, &springs_bar, &system_bar);
    fit->Update(system_bar.rightCols(kContactCount).transpose());
  }
  return report;
}

// The best corrections of the network from these weights on.
LevelValues FitNetwork(const LevelModel& model, const Eigen::VectorXd& common,
                       const Eigen::VectorXd& weights, const Work& work) {
  const TrainOptions::Network& options = model.options().network;
  if (options.epochs == 0) return {common, weights, Eigen::VectorXd::Zero(kContactCount)};
  const CorrectionsFit start(options, model.first().ground.has_value(),
                             model.network().WithoutCorrections(weights));
  const CorrectionsFit fit =
      work.Part("network", kCommonDone, kNetworkDone).Follow(start, [&](CorrectionsFit* one) {
        return StepNetwork(model, common, one);
      });
  return {common, fit.best_weights(), fit.best_contact()};
}

struct SpringsOfLevel {
  Eigen::VectorXd x;
  int iteration = 0;
  double damping = 1e-3, mean_square = 0;

  template <class Visitor>
  void Visit(Visitor&& visit) {
    visit(x, iteration, damping, mean_square);
  }
};

StepReport StepSprings(const LevelModel& model, const Parameters& parameters, SpringsOfLevel* fit) {
  const TrainOptions& options = model.options();
  MotionProblem problem(parameters, model.RoughMotion(kMostSpringRecordings),
                        DirectionDifference(model.first(), options.single_precision));
  GaussNewtonOptions prior = SpringPrior(parameters);
  prior.conjugate_gradient_steps = kLevelConjugateGradients;
  const GaussNewtonState before{fit->x, fit->damping, fit->mean_square, false};
  const GaussNewtonState after = GaussNewtonStep(&problem, before, prior);
  fit->x = after.x;
  fit->damping = after.damping;
  fit->mean_square = after.mean_square;
  if (options.substeps > 0 && !std::isfinite(fit->mean_square)) {
    throw Error(fmt::format("level {} diverges: {} sub-steps a frame are too few", model.level(),
                            options.substeps));
  }
  const bool slow = fit->iteration > 0 && after.mean_square > 0.99 * before.mean_square;
  ++fit->iteration;
  return {fit->iteration >= kLevelGaussNewtonSteps || after.converged || slow,
          static_cast<double>(fit->iteration) / kLevelGaussNewtonSteps,
          fmt::format("level {}, single springs: root mean square {:.3f} mm", model.level(),
                      PointMillimetres(fit->mean_square))};
}

// The system with single springs, fitted from `corrected` on; `mean_square` is that of the fit of
// common factors.
SpringMassSystem FitSpringsOfLevel(const LevelModel& model, const SpringMassSystem& corrected,
                                   double mean_square, const Work& work) {
  const Parameters parameters = SpringFactors(corrected, model.first());
  SpringsOfLevel start{Eigen::VectorXd::Zero(parameters.size())};
  start.mean_square = mean_square;
  const SpringsOfLevel fit =
      work.Follow(start, [&](SpringsOfLevel* one) { return StepSprings(model, parameters, one); });
  return parameters.Apply(fit.x);
}

}  // namespace

FittedLevel FitLevel(const FitData& data, const TrainOptions& options,
                     const std::vector<Twin>& twins, const GraphNetwork& network,
                     const Eigen::VectorXd& weights, const Work& work) {
  std::vector<LevelModel> candidates;
  for (const Twin& twin : twins) candidates.emplace_back(data, options, twin, network);
  const char* common_part = "common factors of coarse levels";

  const int count = static_cast<int>(candidates.size());
  std::vector<CommonFit> tried(candidates.size());
  const Work trial = work.Part(common_part, 0, kTrialsDone);
  ParallelShared(count, options.threads, [&](int i, const std::function<int()>& threads) {
    tried[i] = TryCommonFactors(candidates[i], threads, trial.Item(i, count));
  });
  const std::size_t best = BestOf(tried);
  const LevelModel& model = candidates[best];

  const CommonFit common =
      work.Part(common_part, kTrialsDone, kCommonDone).Follow(tried[best], [&](CommonFit* fit) {
        return StepCommon(model, options.threads, kLastGain, fit);
      });
  const LevelValues values = FitNetwork(model, common.common, weights, work);
  const SpringMassSystem system =
      FitSpringsOfLevel(model, model.Corrected(values), common.mean_square,
                        work.Part("single springs of coarse levels", kNetworkDone, 1));
  return {model.LevelOf(system), values.weights};
}

}  // namespace physpring
