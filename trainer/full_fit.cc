// SPDX-License-Identifier: Apache-2.0
#include "trainer/full_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "trainer/adam.h"
#include "trainer/free_motion_descent.h"
#include "trainer/observer.h"
#include "twin/error.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr int kMostCommonRecordings = 4;   // that common factors are fitted to
constexpr int kStepsPerGain = 6;           // of common factors
constexpr int kFirstChainGain = 3;         // of a chain's, which go on from those of the choice ...
constexpr int kChainStepsPerGain = 20;     // ... and take longer
constexpr int kMostSearchRecordings = 24;  // of free motions of a chain
constexpr int kDescents = 6;               // of a chain's shape after the search
constexpr int kFirstSpringGain = 3;        // of kObserverGains
constexpr int kFollowedSteps = 3;          // of Gauss-Newton with each gain before the last ...
constexpr int kGaussNewtonSteps = 15;      // ... and with that one
constexpr int kAdamSteps = 200;
constexpr int kPatience = 40;           // Adam ends after so many steps in a row that gain little
constexpr double kLearningRate = 0.03;  // of log-stiffnesses; others in proportion to their prior
constexpr double kAstray = 1.5;  // Adam turns back where the mean square is so much above the best

// Parts of the time at which stages are done, as measured on recordings of 80 to 500 particles.
constexpr double kChosen = 0.45, kCommon = 0.5, kFollowed = 0.7, kSprings = 0.8;
constexpr double kChainCommon = 0.7, kSearched = 0.85;  // of a chain: goes on with free motions

}  // namespace

FullFit::FullFit(FitData data, const TrainOptions& options)
    : data_(std::move(data)),
      options_(options),
      choice_(data_, options_),
      all_(FitEpisodes(data_, kMostSpringRecordings)) {}

Parameters FullFit::SpringParameters() const {
  return SpringFactors(model_.System(first()), first(), model_.candidate.free_effects);
}

SpringMassSystem FullFit::CurrentSystem() const {
  if (state_.stage > Stage::kDescend) return SpringParameters().Apply(state_.x);
  return (state_.stage == Stage::kChoose ? choice_.Best() : model_).System(first());
}

void FullFit::StepChoose() {
  if (choice_.Step()) {
    status_ = choice_.status();
    return;
  }
  model_ = choice_.Best();
  if (choice_.BestSprings().size() > 0 && GaussNewtonSteps() > 0) {
    BeginGaussNewton(choice_.BestSprings());
    return;
  }
  state_.stage = Stage::kCommon;
  state_.iteration = 0;
  state_.gain = 0;
  state_.damping = 1e-2;
  if (model_.candidate.is_chain()) {
    state_.gain = kFirstChainGain;
  } else {
    model_.factors = model_.start;
  }
}

// A chain that bends (fit_model.h) has no more than common factors: they get what single springs
// would get, more recordings and more steps.
void FullFit::StepCommon() {
  const bool chain = model_.candidate.is_chain();
  const LevenbergMarquardtState factors =
      StepFactors(model_, chain ? all_ : FitEpisodes(data_, kMostCommonRecordings), options_,
                  kObserverGains[state_.gain], state_.damping);
  model_.factors = factors.x;
  state_.damping = factors.damping;
  state_.mean_square = factors.mean_square;
  status_ = fmt::format("{}, all fit frames: {:.3f} mm", model_.candidate.Label(),
                        PointMillimetres(factors.mean_square));
  const int steps = chain ? kChainStepsPerGain : kStepsPerGain;
  if (++state_.iteration < steps && !factors.converged) return;
  state_.iteration = 0;
  state_.damping = 1e-2;
  if (++state_.gain <= kLastGain) return;
  if (chain) {
    state_.stage = Stage::kSearch;
    BeginSearch();
    return;
  }
  BeginGaussNewton(Eigen::VectorXd::Zero(SpringParameters().size()));
  if (GaussNewtonSteps() == 0) BeginAdam(true);
}

void FullFit::BeginSearch() {
  search_.emplace(model_.factors, model_.Factors(first()).WholeBodyEntries(), options_.epochs,
                  options_.seed);
}

void FullFit::StepSearch() {
  search_->Step(model_, FitEpisodes(data_, kMostSearchRecordings), options_);
  status_ = fmt::format("{}, free motions: {:.3f} mm", model_.candidate.Label(),
                        1e3 * search_->best_error());
  model_.factors = search_->BestFactors();
  if (!search_->done()) return;
  state_.stage = Stage::kDescend;
  state_.iteration = 0;
  state_.error = search_->best_error();
}

void FullFit::StepDescend() {
  FreeMotionDescent descent{model_.factors, state_.error, false};
  descent = DescendFreeMotions(model_, model_.Factors(first()).AlongBodyEntries(),
                               FitEpisodes(data_, kMostSearchRecordings), options_, descent);
  model_.factors = descent.factors;
  state_.error = descent.error;
  status_ =
      fmt::format("{}, free motions: {:.3f} mm", model_.candidate.Label(), 1e3 * state_.error);
  if (++state_.iteration < kDescents && !descent.converged) return;
  state_.x = state_.best = Eigen::VectorXd::Zero(SpringParameters().size());
  state_.stage = Stage::kDone;
}

void FullFit::BeginGaussNewton(const Eigen::VectorXd& x) {
  state_.stage = Stage::kGaussNewton;
  state_.gain = kFirstSpringGain;
  state_.x = x;
  state_.iteration = state_.slow = 0;
  state_.damping = 1e-3;
}

int FullFit::GaussNewtonSteps() const {
  switch (options_.optimizer) {
    case TrainOptions::Optimizer::kAutomatic:
      return kGaussNewtonSteps;
    case TrainOptions::Optimizer::kGaussNewton:
      return options_.epochs > 0 ? options_.epochs : kGaussNewtonSteps;
    case TrainOptions::Optimizer::kAdam:
      return 0;
  }
  return 0;
}

int FullFit::AdamSteps() const {
  if (options_.optimizer == TrainOptions::Optimizer::kGaussNewton) return 0;
  return options_.epochs > 0 ? options_.epochs : kAdamSteps;
}

void FullFit::StepGaussNewton() {
  const Parameters parameters = SpringParameters();
  MotionProblem::Options follow = FollowOptions(first(), model_.candidate, options_);
  follow.rollout.growth_limit = std::numeric_limits<double>::infinity();
  follow.rollout.observer_gain = kObserverGains[state_.gain];
  MotionProblem problem(parameters, all_, follow);
  const GaussNewtonState before{state_.x, state_.damping, state_.mean_square, false};
  const GaussNewtonState after = GaussNewtonStep(&problem, before, SpringPrior(parameters));
  state_.x = after.x;
  state_.damping = after.damping;
  state_.mean_square = after.mean_square;
  status_ = fmt::format("single springs: root mean square {:.3f} mm",
                        PointMillimetres(after.mean_square));
  const bool first_step = state_.iteration++ == 0;
  const bool stuck = IsStuck(before, after, first_step);
  const bool gained = first_step || after.mean_square < kSlowStep * before.mean_square;
  state_.slow = gained ? 0 : state_.slow + 1;
  if (state_.gain < kLastGain) {
    if (!stuck && state_.slow < kMostSlowSteps && state_.iteration < kFollowedSteps) return;
    ++state_.gain;
    state_.iteration = state_.slow = 0;
    state_.damping = 1e-3;
    return;
  }
  // with little to gain early on, the residuals are too rough for it
  if (stuck || state_.slow == kMostSlowSteps || state_.iteration >= GaussNewtonSteps()) {
    BeginAdam(state_.iteration < GaussNewtonSteps());
  }
}

void FullFit::BeginAdam(bool wanted) {
  const bool asked = options_.optimizer == TrainOptions::Optimizer::kAdam || options_.epochs > 0;
  state_.stage = AdamSteps() > 0 && (wanted || asked) ? Stage::kAdam : Stage::kDone;
  state_.iteration = 0;
  state_.rate = 1;
  state_.best = state_.x;
  state_.best_mean_square = std::numeric_limits<double>::infinity();
  state_.gained_mean_square = std::numeric_limits<double>::infinity();
  state_.slow = 0;
}

// One iteration of Adam on |r|^2 / variance + prior, the variance being the current mean of r^2.
// Where it went astray it goes on from the best, half as fast and with a fresh momentum.
void FullFit::StepAdam() {
  const Parameters parameters = SpringParameters();
  const GaussNewtonOptions prior = SpringPrior(parameters);
  MotionProblem problem(parameters, all_, FollowOptions(first(), model_.candidate, options_));
  Adam adam(parameters.size());
  if (state_.iteration > 0) {
    adam.steps = state_.iteration;
    adam.mean = state_.adam_mean;
    adam.mean_square = state_.adam_mean_square;
  }
  const auto r = problem.Linearise(state_.x);
  const double mean_square = r ? r->squaredNorm() / static_cast<double>(r->size())
                               : std::numeric_limits<double>::infinity();
  if (mean_square < state_.best_mean_square) {
    state_.best_mean_square = mean_square;
    state_.best = state_.x;
  }
  ++state_.slow;
  if (state_.best_mean_square < kSlowStep * state_.gained_mean_square) {
    state_.gained_mean_square = state_.best_mean_square;
    state_.slow = 0;
  }
  if (r && mean_square < kAstray * state_.best_mean_square) {
    const Eigen::VectorXd gradient =
        problem.JacobianTransposedTimes(*r) / mean_square + prior.precision.cwiseProduct(state_.x);
    // steps in proportion to the prior's deviations, falling as a cosine
    const double part = static_cast<double>(state_.iteration) / AdamSteps();
    const double rate = state_.rate * kLearningRate * 0.5 * (1 + std::cos(M_PI * part));
    const Eigen::VectorXd rates =
        rate * (2 * prior.precision.cwiseSqrt().cwiseInverse()).cwiseMin(1);
    adam.Step(gradient, rates, &state_.x);
  } else {
    state_.x = state_.best;
    state_.rate *= 0.5;
    adam.mean.setZero();
  }
  state_.mean_square = state_.best_mean_square;
  state_.adam_mean = adam.mean;
  state_.adam_mean_square = adam.mean_square;
  status_ = fmt::format(
      "single springs: root mean square {:.3f} mm, best {:.3f}{}", PointMillimetres(mean_square),
      PointMillimetres(state_.best_mean_square),
      problem.cuts() > 0 ? fmt::format(" (adjoint cut into {} windows)", problem.cuts() + 1) : "");
  const bool stuck = state_.slow >= kPatience && options_.epochs == 0;
  if (++state_.iteration < AdamSteps() && !stuck) return;
  state_.x = state_.best;
  state_.stage = Stage::kDone;
}

bool FullFit::Step() {
  switch (state_.stage) {
    case Stage::kChoose:
      StepChoose();
      return true;
    case Stage::kCommon:
      StepCommon();
      return true;
    case Stage::kSearch:
      StepSearch();
      return true;
    case Stage::kDescend:
      StepDescend();
      return true;
    case Stage::kGaussNewton:
      StepGaussNewton();
      return true;
    case Stage::kAdam:
      StepAdam();
      return true;
    case Stage::kDone:
      return false;
  }
  return false;
}

double FullFit::Progress() const {
  const auto between = [](double begin, double end, double part) {
    return begin + (end - begin) * part;
  };
  switch (state_.stage) {
    case Stage::kChoose:
      return between(0, kChosen, choice_.Progress());
    case Stage::kCommon:
      if (model_.candidate.is_chain()) {
        const double part = static_cast<double>(state_.iteration) / kChainStepsPerGain;
        return between(kChosen, kChainCommon,
                       (state_.gain - kFirstChainGain + part) / (kLastGain + 1 - kFirstChainGain));
      }
      return between(kChosen, kCommon, static_cast<double>(state_.gain) / (kLastGain + 1));
    case Stage::kSearch:
      return between(kChainCommon, kSearched, search_->Progress());
    case Stage::kDescend:
      return between(kSearched, 1, static_cast<double>(state_.iteration) / kDescents);
    case Stage::kGaussNewton:
      if (state_.gain < kLastGain) {
        return between(kCommon, kFollowed,
                       (state_.gain - kFirstSpringGain +
                        static_cast<double>(state_.iteration) / kFollowedSteps) /
                           (kLastGain - kFirstSpringGain));
      }
      return between(kFollowed, kSprings,
                     static_cast<double>(state_.iteration) / GaussNewtonSteps());
    case Stage::kAdam:
      return between(kSprings, 1, static_cast<double>(state_.iteration) / AdamSteps());
    case Stage::kDone:
      return 1;
  }
  return 0;
}

std::string FullFit::Part() const {
  switch (state_.stage) {
    case Stage::kChoose:
      return "choosing the model";
    case Stage::kCommon:
      return "common factors";
    case Stage::kSearch:
      return "search among free motions";
    case Stage::kDescend:
      return "descent of free motions";
    case Stage::kGaussNewton:
      return "single springs (Gauss-Newton)";
    case Stage::kAdam:
      return "single springs (Adam)";
    case Stage::kDone:
      break;
  }
  return "";
}

std::map<std::string, NpzArray> FullFit::Save() const {
  StateArrays arrays;
  choice_.Save(&arrays);
  arrays["train/stage"] =
      StoreCounters({static_cast<int>(state_.stage), state_.iteration, state_.slow, state_.gain,
                     static_cast<int>(model_.factors.size()), static_cast<int>(state_.x.size()),
                     static_cast<int>(state_.adam_mean.size())});
  Eigen::VectorXd scalars(6);
  scalars << state_.damping, state_.mean_square, state_.rate, state_.best_mean_square,
      state_.gained_mean_square, state_.error;
  arrays["train/scalars"] = StoreVector(scalars);
  arrays["train/factors"] = StoreVector(model_.factors);
  arrays["train/x"] = StoreVector(state_.x);
  arrays["train/best"] = StoreVector(state_.best);
  arrays["train/adam_mean"] = StoreVector(state_.adam_mean);
  arrays["train/adam_mean_square"] = StoreVector(state_.adam_mean_square);
  if (state_.stage == Stage::kSearch) search_->Save(&arrays);
  return arrays;
}

void FullFit::Load(const std::map<std::string, NpzArray>& arrays) {
  choice_.Load(arrays);
  const std::vector<int> counters = LoadCounters(arrays, "stage", 7);
  state_.stage = static_cast<Stage>(counters[0]);
  state_.iteration = counters[1];
  state_.slow = counters[2];
  state_.gain = counters[3];
  const Eigen::VectorXd scalars = LoadVector(arrays, "scalars", 6);
  state_.damping = scalars[0];
  state_.mean_square = scalars[1];
  state_.rate = scalars[2];
  state_.best_mean_square = scalars[3];
  state_.gained_mean_square = scalars[4];
  state_.error = scalars[5];
  model_ = choice_.Best();
  model_.factors = LoadVector(arrays, "factors", counters[4]);
  state_.x = LoadVector(arrays, "x", counters[5]);
  state_.best = LoadVector(arrays, "best", state_.stage >= Stage::kAdam ? counters[5] : 0);
  state_.adam_mean = LoadVector(arrays, "adam_mean", counters[6]);
  state_.adam_mean_square = LoadVector(arrays, "adam_mean_square", counters[6]);
  if (state_.stage == Stage::kSearch) {
    BeginSearch();
    search_->Load(arrays);
  }
}

Twin FullFit::Result() const {
  const Candidate candidate =
      state_.stage == Stage::kChoose ? choice_.Best().candidate : model_.candidate;
  Twin twin;
  TwinLevel level;
  level.system = CurrentSystem();
  const int substeps = options_.substeps > 0 ? options_.substeps
                                             : StableSubsteps(ComputeStabilityBound(level.system),
                                                              1 / first().fps, kStepSafety);
  level.substeps_per_second = static_cast<int>(std::ceil(substeps * first().fps));
  twin.levels.push_back(std::move(level));
  twin.points = first().point_count();
  twin.interior = first().interior_count();
  twin.order = first().order;
  twin.controller_velocity = candidate.controller_velocity;
  twin.fps = first().fps;
  twin.gravity = first().gravity;
  twin.seed = options_.seed;
  return twin;
}

}  // namespace physpring
