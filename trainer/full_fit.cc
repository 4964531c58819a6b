// SPDX-License-Identifier: Apache-2.0
#include "trainer/full_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "trainer/adam.h"
#include "trainer/start_system.h"
#include "twin/error.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr double kSafety = 0.7;                        // of the sub-step
constexpr int kMostRecordings = 4;                     // that start values are sought on
constexpr int kMostSpringRecordings = 12;              // that single springs are fitted to
constexpr std::array<double, 2> kHorizons = {0.3, 1};  // parts of the fit frames
constexpr std::array<int, 2> kFactorSteps = {8, 30};   // at most, of each horizon
constexpr int kCommonSteps = 12;
constexpr int kGaussNewtonSteps = 12;
constexpr int kAdamSteps = 120;
constexpr double kLearningRate = 0.03;  // of log-stiffnesses; others in proportion to their prior
// Sub-steps a second, at most (half of PhysTwin's): no stiffness is taken that would need more.
constexpr double kMostSubsteps = 10000;
// Start systems tried, in sub-steps a frame.
constexpr double kSoftest = 2, kStiffest = 64;
constexpr double kCheaper = 1.03;  // a larger neighbour count must be better by this factor

// Standard deviations of the prior on the springs' own parts.
constexpr double kOwnStiffness = 0.5, kOwnDashpot = 0.5, kOwnRestLength = 0.01;

NpzArray Vector(const Eigen::VectorXd& v) {
  return NpzArray::Doubles({static_cast<std::size_t>(v.size())}, v.data());
}

std::vector<Episode> Shorten(std::vector<Episode> episodes, double part) {
  for (Episode& episode : episodes) {
    episode.frames = std::clamp(static_cast<int>(part * episode.frames), 2, episode.frames);
  }
  return episodes;
}

}  // namespace

FullFit::FullFit(FitData data, const TrainOptions& options)
    : data_(std::move(data)), options_(options), candidates_(options.neighbours) {
  const Recording& first = data_.recordings.at(0);
  if (candidates_.empty()) {
    candidates_ =
        first.order.size() > 0 ? std::vector<int>{12, 20} : std::vector<int>{18, 26};
    // more neighbours than there are particles are all the same
    const int most = std::max(1, first.particle_count() - 1);
    for (int& candidate : candidates_) candidate = std::min(candidate, most);
    candidates_.erase(std::unique(candidates_.begin(), candidates_.end()), candidates_.end());
  }
  held_back_ = HoldBack(data_, kMostRecordings);
  all_ = FitEpisodes(data_, kMostSpringRecordings);
  state_.score = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(candidates_.size()),
                                           std::numeric_limits<double>::infinity());
  StartSystem(0, kSoftest);  // throws where the recording gives no body
}

SpringMassSystem FullFit::StartSystem(int candidate, double start_substeps) const {
  const Recording& recording = data_.recordings[0];
  TopologyOptions topology;
  topology.max_neighbours = topology.controller_max_neighbours = candidates_[candidate];
  SpringMassSystem system = MakeStartSystem(recording, topology);
  ScaleToSubsteps(1 / recording.fps, start_substeps, kSafety, &system);
  return system;
}

TrackProblem::Options FullFit::ProblemOptions() const {
  TrackProblem::Options problem;
  problem.rollout.single_precision = options_.single_precision;
  problem.rollout.controller_velocity = options_.controller_velocity;
  problem.rollout.substeps = options_.substeps;
  problem.safety = kSafety;
  problem.most_substeps = static_cast<int>(std::ceil(kMostSubsteps / data_.recordings[0].fps));
  problem.difference = HasGround() ? 1e-3 : 1e-5;
  problem.threads = options_.threads;
  return problem;
}

Parameters FullFit::CommonParameters(const SpringMassSystem& base) const {
  ParameterOptions options;
  options.spring_stiffness = options.spring_dashpot = options.spring_rest_length = false;
  options.contact = HasGround();
  return Parameters(base, options);
}

Parameters FullFit::SpringParameters() const {
  const SpringMassSystem start = StartSystem(state_.candidate, state_.start_substeps);
  ParameterOptions options;
  options.spring_stiffness = options.spring_dashpot = options.spring_rest_length = true;
  options.contact = HasGround();
  return Parameters(CommonParameters(start).Apply(state_.best_x), options);
}

SpringMassSystem FullFit::CurrentSystem() const {
  if (state_.stage != Stage::kChoose && state_.stage != Stage::kCommon) {
    return SpringParameters().Apply(state_.x);
  }
  if (state_.start_substeps > 0) {
    const SpringMassSystem start = StartSystem(state_.candidate, state_.start_substeps);
    return CommonParameters(start).Apply(state_.x);
  }
  if (state_.best_candidate < 0) return StartSystem(0, kSoftest);
  const SpringMassSystem start = StartSystem(state_.best_candidate, state_.best_start_substeps);
  return CommonParameters(start).Apply(state_.best_x);
}

// Among a few start systems from soft to stiff, the one that predicts the fit frames best.
double FullFit::SearchStart(int candidate) const {
  double best = kSoftest, least = std::numeric_limits<double>::infinity();
  for (double substeps = kSoftest; substeps <= kStiffest; substeps *= 2) {
    const Parameters parameters = CommonParameters(StartSystem(candidate, substeps));
    TrackProblem problem(parameters, held_back_.fit, ProblemOptions());
    const auto r = problem.Residuals(Eigen::VectorXd::Zero(parameters.size()));
    if (r && r->squaredNorm() < least) {
      least = r->squaredNorm();
      best = substeps;
    }
  }
  return best;
}

double FullFit::HeldBackError(const SpringMassSystem& system) const {
  double sum = 0;
  for (const ScoredFrames& scored : held_back_.scored) {
    RolloutOptions options = ProblemOptions().rollout;
    if (options.substeps == 0) {
      options.substeps =
          StableSubsteps(ComputeStabilityBound(system), 1 / scored.recording->fps, kSafety);
    }
    const auto rollout = RollOut(system, {scored.recording, scored.last}, options);
    if (rollout->diverged()) return std::numeric_limits<double>::infinity();
    double error = 0;
    int frames = 0;
    for (int frame = scored.first; frame < scored.last; ++frame) {
      const Points& measured = scored.recording->points[frame];
      double frame_error = 0;
      int seen = 0;
      for (int i = 0; i < measured.cols(); ++i) {
        if (std::isnan(measured(0, i))) continue;
        frame_error += (rollout->positions()[frame].col(i) - measured.col(i)).norm();
        ++seen;
      }
      if (seen == 0) continue;
      error += frame_error / seen;
      ++frames;
    }
    if (frames > 0) sum += error / frames;
  }
  return sum / static_cast<double>(std::max<std::size_t>(1, held_back_.scored.size()));
}

LevenbergMarquardtState FullFit::StepFactors(const Parameters& parameters,
                                             const std::vector<Episode>& episodes,
                                             int difference_threads) {
  TrackProblem::Options problem_options = ProblemOptions();
  problem_options.threads = 1;  // the differences run in parallel
  TrackProblem problem(parameters, episodes, problem_options);
  LevenbergMarquardtOptions options;
  options.threads = difference_threads;
  options.difference = HasGround() ? 1e-2 : 1e-3;
  LevenbergMarquardtState factors;
  factors.x = state_.x;
  factors.damping = state_.damping;
  factors = LevenbergMarquardtStep([&](const Eigen::VectorXd& x) { return problem.Residuals(x); },
                                   factors, options);
  state_.x = factors.x;
  state_.damping = factors.damping;
  state_.mean_square = factors.mean_square;
  ++state_.iteration;
  return factors;
}

void FullFit::ExpectSomeSuccess() const {
  if (std::isfinite(state_.score.minCoeff())) return;
  throw Error(fmt::format(
      "recording {}: the motion diverges with every start value tried{}", data_.recordings[0].name,
      options_.substeps > 0 ? fmt::format("; {} sub-steps a frame are too few", options_.substeps)
                            : ", even with a stable sub-step; are its positions in metres?"));
}

void FullFit::StepChoose() {
  if (state_.start_substeps == 0) {
    state_.start_substeps = SearchStart(state_.candidate);
    state_.horizon = state_.iteration = 0;
    state_.damping = 1e-2;
    const Parameters parameters =
        CommonParameters(StartSystem(state_.candidate, state_.start_substeps));
    state_.x = Eigen::VectorXd::Zero(parameters.size());
  }
  const Parameters parameters =
      CommonParameters(StartSystem(state_.candidate, state_.start_substeps));
  const auto factors =
      StepFactors(parameters, Shorten(held_back_.fit, kHorizons[state_.horizon]), options_.threads);
  status_ = fmt::format("{} neighbours, start values: {:.3f} mm", candidates_[state_.candidate],
                        1e3 * std::sqrt(3 * factors.mean_square));
  if (!factors.converged && state_.iteration < kFactorSteps[state_.horizon]) return;
  if (++state_.horizon < static_cast<int>(kHorizons.size())) {
    state_.iteration = 0;
    return;
  }

  // this candidate is done: is it the best so far?
  const int candidate = state_.candidate;
  state_.score[candidate] = HeldBackError(parameters.Apply(state_.x));
  status_ = fmt::format("{} neighbours: {:.3f} mm on held-back frames", candidates_[candidate],
                        1e3 * state_.score[candidate]);
  if (state_.best_candidate < 0 ||
      kCheaper * state_.score[candidate] < state_.score[state_.best_candidate]) {
    state_.best_candidate = candidate;
    state_.best_start_substeps = state_.start_substeps;
    state_.best_x = state_.x;
  }
  state_.start_substeps = 0;
  if (++state_.candidate < static_cast<int>(candidates_.size())) return;

  ExpectSomeSuccess();
  state_.candidate = state_.best_candidate;
  state_.start_substeps = state_.best_start_substeps;
  state_.x = state_.best_x;
  state_.stage = Stage::kCommon;
  state_.iteration = 0;
  state_.damping = 1e-2;
}

void FullFit::StepCommon() {
  const Parameters parameters =
      CommonParameters(StartSystem(state_.candidate, state_.start_substeps));
  const auto factors =
      StepFactors(parameters, FitEpisodes(data_, kMostRecordings), options_.threads);
  status_ = fmt::format("{} neighbours, all fit frames: {:.3f} mm", candidates_[state_.candidate],
                        1e3 * std::sqrt(3 * factors.mean_square));
  if (!factors.converged && state_.iteration < kCommonSteps) return;
  state_.best_x = state_.x;
  state_.stage = Stage::kGaussNewton;
  state_.x = Eigen::VectorXd::Zero(SpringParameters().size());
  state_.iteration = 0;
  state_.damping = 1e-3;
  if (GaussNewtonSteps() == 0) BeginAdam();
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

GaussNewtonOptions FullFit::Prior(const Parameters& parameters) const {
  GaussNewtonOptions options;
  options.conjugate_gradient_steps = 50;
  options.precision.resize(parameters.size());
  options.scale.resize(parameters.size());
  for (int i = 0; i < parameters.size(); ++i) {
    double deviation = 3, scale = 30;
    switch (parameters.kind(i)) {
      case Parameters::Kind::kGlobal:
        break;
      case Parameters::Kind::kStiffness:
        deviation = kOwnStiffness, scale = 1;
        break;
      case Parameters::Kind::kDashpot:
        deviation = kOwnDashpot, scale = 1;
        break;
      case Parameters::Kind::kRestLength:
        deviation = kOwnRestLength, scale = 100;
        break;
    }
    options.precision[i] = 1 / (deviation * deviation);
    options.scale[i] = scale;
  }
  return options;
}

void FullFit::StepGaussNewton() {
  const Parameters parameters = SpringParameters();
  TrackProblem::Options problem_options = ProblemOptions();
  problem_options.rollout.growth_limit = std::numeric_limits<double>::infinity();
  TrackProblem problem(parameters, all_, problem_options);
  const GaussNewtonState before{state_.x, state_.damping, state_.mean_square, false};
  const GaussNewtonState after = GaussNewtonStep(&problem, before, Prior(parameters));
  state_.x = after.x;
  state_.damping = after.damping;
  state_.mean_square = after.mean_square;
  ++state_.iteration;
  status_ = fmt::format("single springs: {:.3f} mm", 1e3 * std::sqrt(3 * after.mean_square));
  // it gets on while a step lowers the mean square by a hundredth
  const bool slow = state_.iteration > 1 && after.mean_square > 0.99 * before.mean_square;
  if (after.converged || slow || state_.iteration >= GaussNewtonSteps()) BeginAdam();
}

void FullFit::BeginAdam() {
  state_.stage = AdamSteps() > 0 ? Stage::kAdam : Stage::kDone;
  state_.iteration = 0;
  state_.best_springs = state_.x;
  state_.best_mean_square = std::numeric_limits<double>::infinity();
}

// One iteration of Adam on |r|^2 / variance + prior, the variance being the current mean of r^2.
void FullFit::StepAdam() {
  const Parameters parameters = SpringParameters();
  const GaussNewtonOptions prior = Prior(parameters);
  TrackProblem problem(parameters, all_, ProblemOptions());
  Adam adam(parameters.size());
  if (state_.iteration > 0) {
    adam.steps = state_.iteration;
    adam.mean = state_.adam_mean;
    adam.mean_square = state_.adam_mean_square;
  }
  const auto r = problem.Linearise(state_.x);
  if (r) {
    state_.mean_square = r->squaredNorm() / static_cast<double>(r->size());
    if (state_.mean_square < state_.best_mean_square) {
      state_.best_mean_square = state_.mean_square;
      state_.best_springs = state_.x;
    }
    const Eigen::VectorXd gradient = problem.JacobianTransposedTimes(*r) / state_.mean_square +
                                     prior.precision.cwiseProduct(state_.x);
    // steps in proportion to the prior's deviations, falling as a cosine
    const double part = static_cast<double>(state_.iteration) / AdamSteps();
    const double rate = kLearningRate * 0.5 * (1 + std::cos(M_PI * part));
    Eigen::VectorXd rates(parameters.size());
    for (int i = 0; i < parameters.size(); ++i) {
      rates[i] = rate * std::min(1.0, 2 / std::sqrt(prior.precision[i]));
    }
    adam.Step(gradient, rates, &state_.x);
  } else {  // too far: back to the best, and on from there with a fresh momentum
    state_.x = state_.best_springs;
    adam.mean.setZero();
  }
  state_.adam_mean = adam.mean;
  state_.adam_mean_square = adam.mean_square;
  ++state_.iteration;
  status_ = fmt::format(
      "single springs: {:.3f} mm{}", 1e3 * std::sqrt(3 * state_.mean_square),
      problem.cuts() > 0 ? fmt::format(" (adjoint cut into {} windows)", problem.cuts() + 1) : "");
  if (state_.iteration < AdamSteps()) return;
  state_.x = state_.best_springs;
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

// Shares of the time as measured on recordings of 80 to 500 particles.
double FullFit::Progress() const {
  const double candidates = static_cast<double>(candidates_.size());
  switch (state_.stage) {
    case Stage::kChoose: {
      const double within = state_.horizon == 0 ? 0.2 * state_.iteration / kFactorSteps[0]
                                                : 0.2 + 0.8 * state_.iteration / kFactorSteps[1];
      return 0.4 * (state_.candidate + within) / candidates;
    }
    case Stage::kCommon:
      return 0.4 + 0.1 * state_.iteration / kCommonSteps;
    case Stage::kGaussNewton:
      return 0.5 + 0.3 * state_.iteration / GaussNewtonSteps();
    case Stage::kAdam:
      return 0.8 + 0.2 * state_.iteration / AdamSteps();
    case Stage::kDone:
      return 1;
  }
  return 0;
}

std::map<std::string, NpzArray> FullFit::Save() const {
  const std::array<int, 5> counters = {static_cast<int>(state_.stage), state_.candidate,
                                       state_.horizon, state_.iteration, state_.best_candidate};
  const std::array<double, 5> scalars = {state_.start_substeps, state_.damping, state_.mean_square,
                                         state_.best_start_substeps, state_.best_mean_square};
  return {{"train/counters", NpzArray::Ints({counters.size()}, counters.data())},
          {"train/scalars", NpzArray::Doubles({scalars.size()}, scalars.data())},
          {"train/x", Vector(state_.x)},
          {"train/score", Vector(state_.score)},
          {"train/best_x", Vector(state_.best_x)},
          {"train/adam_mean", Vector(state_.adam_mean)},
          {"train/adam_mean_square", Vector(state_.adam_mean_square)},
          {"train/best_springs", Vector(state_.best_springs)}};
}

void FullFit::Load(const std::map<std::string, NpzArray>& arrays) {
  const auto get = [&](const std::string& name, int size) {
    const auto found = arrays.find("train/" + name);
    if (found == arrays.end())
      throw Error("cannot resume: the array train/" + name + " is missing");
    const std::vector<double> values = found->second.ToDoubles();
    if (size >= 0 && static_cast<int>(values.size()) != size) {
      throw Error(fmt::format("cannot resume: train/{} has {} values, expected {}", name,
                              values.size(), size));
    }
    return Eigen::VectorXd(
        Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  };
  const Eigen::VectorXd counters = get("counters", 5), scalars = get("scalars", 5);
  state_.stage = static_cast<Stage>(static_cast<int>(counters[0]));
  state_.candidate = static_cast<int>(counters[1]);
  state_.horizon = static_cast<int>(counters[2]);
  state_.iteration = static_cast<int>(counters[3]);
  state_.best_candidate = static_cast<int>(counters[4]);
  state_.start_substeps = scalars[0];
  state_.damping = scalars[1];
  state_.mean_square = scalars[2];
  state_.best_start_substeps = scalars[3];
  state_.best_mean_square = scalars[4];
  state_.x = get("x", -1);
  state_.score = get("score", static_cast<int>(candidates_.size()));
  state_.best_x = get("best_x", -1);
  state_.adam_mean = get("adam_mean", -1);
  state_.adam_mean_square = get("adam_mean_square", -1);
  state_.best_springs = get("best_springs", -1);
}

Twin FullFit::Result() const {
  const Recording& recording = data_.recordings[0];
  Twin twin;
  TwinLevel level;
  level.system = CurrentSystem();
  const int substeps = options_.substeps > 0 ? options_.substeps
                                             : StableSubsteps(ComputeStabilityBound(level.system),
                                                              1 / recording.fps, kSafety);
  level.substeps_per_second = static_cast<int>(std::ceil(substeps * recording.fps));
  twin.levels.push_back(std::move(level));
  twin.points = recording.point_count();
  twin.interior = recording.interior_count();
  twin.order = recording.order;
  twin.controller_velocity = options_.controller_velocity;
  twin.fps = recording.fps;
  twin.gravity = recording.gravity;
  twin.seed = options_.seed;
  return twin;
}

}  // namespace physpring
