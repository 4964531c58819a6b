// SPDX-License-Identifier: Apache-2.0
#include "trainer/model_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "twin/error.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr int kMostRecordings = 4;                     // that start values are sought on
constexpr std::array<double, 2> kHorizon = {0.3, 1};   // part of the fit frames, of two rounds
constexpr std::array<int, 3> kMostSteps = {8, 30, 4};  // of each round
constexpr int kSpringSteps = 20;                       // of conjugate gradients
constexpr int kFinalists = 2;
constexpr int kRounds = 3;
// Start systems tried, in sub-steps a frame, and (on a ground) changes of the friction's factor.
constexpr double kSoftest = 2, kStiffest = 64;
constexpr std::array<double, 3> kFrictions = {0, -1, 1.2};
constexpr double kInfinity = std::numeric_limits<double>::infinity();

int Part(int frames, double part) { return std::clamp(static_cast<int>(part * frames), 2, frames); }

std::vector<Episode> Shorten(std::vector<Episode> episodes, double part) {
  for (Episode& episode : episodes) episode.frames = Part(episode.frames, part);
  return episodes;
}

// The mean over frames of the mean distance of the points seen.
double FramesError(const std::vector<Points>& positions, const ScoredFrames& scored) {
  double error = 0;
  int frames = 0;
  for (int frame = scored.first; frame < scored.last; ++frame) {
    const Points& measured = scored.recording->points[frame];
    double frame_error = 0;
    int seen = 0;
    for (int i = 0; i < measured.cols(); ++i) {
      if (std::isnan(measured(0, i))) continue;
      frame_error += (positions[frame].col(i) - measured.col(i)).norm();
      ++seen;
    }
    if (seen == 0) continue;
    error += frame_error / seen;
    ++frames;
  }
  return frames > 0 ? error / frames : 0;
}

}  // namespace

LevenbergMarquardtState StepFactors(const ChosenModel& model, const std::vector<Episode>& episodes,
                                    const TrainOptions& options, double damping) {
  const Recording& recording = *episodes.at(0).recording;
  TrackProblem::Options follow = FollowOptions(recording, model.candidate, options);
  follow.threads = 1;  // the differences run in parallel
  follow.most_substeps /= 2;
  const Parameters factors =
      CommonFactors(StartSystem(recording, model.candidate, model.start_substeps), recording);
  TrackProblem problem(factors, episodes, follow);
  LevenbergMarquardtOptions levenberg;
  levenberg.threads = options.threads;
  levenberg.difference = recording.ground ? 1e-2 : 1e-3;
  LevenbergMarquardtState state;
  state.x = model.factors;
  state.damping = damping;
  return LevenbergMarquardtStep([&](const Eigen::VectorXd& x) { return problem.Residuals(x); },
                                state, levenberg);
}

SpringMassSystem ChosenModel::System(const Recording& recording) const {
  return CommonFactors(StartSystem(recording, candidate, start_substeps), recording).Apply(factors);
}

ModelChoice::ModelChoice(const FitData& data, const TrainOptions& options)
    : data_(data), options_(options), held_back_(HoldBack(data, kMostRecordings)) {
  for (const Candidate& candidate : Candidates(first(), options)) {
    contenders_.push_back({{candidate, 0, {}}, kInfinity});
  }
  BeginRound();
  StartSystem(first(), contenders_[0].model.candidate, kSoftest);  // throws where there is no body
}

// Among a few start systems from soft to stiff, slippery to rough, the one that predicts best.
void ModelChoice::SearchStart(ChosenModel* model) const {
  double least = kInfinity;
  for (double substeps = kSoftest; substeps <= kStiffest; substeps *= 2) {
    const Parameters factors =
        CommonFactors(StartSystem(first(), model->candidate, substeps), first());
    TrackProblem problem(factors, held_back_.fit,
                         FollowOptions(first(), model->candidate, options_));
    for (double friction : kFrictions) {
      Eigen::VectorXd x = Eigen::VectorXd::Zero(factors.size());
      if (factors.friction() >= 0) x[factors.friction()] = friction;
      if (model->start_substeps == 0) *model = {model->candidate, substeps, x};
      if (factors.friction() < 0 && friction != 0) continue;
      const auto r = problem.Residuals(x);
      if (!r || r->squaredNorm() >= least) continue;
      least = r->squaredNorm();
      *model = {model->candidate, substeps, x};
    }
  }
}

// The first round is judged by the fit frames that it did not fit, the others by the held-back
// ones.
std::vector<ScoredFrames> ModelChoice::JudgedBy() const {
  if (round_ > 0) return held_back_.scored;
  std::vector<ScoredFrames> scored;
  for (const Episode& episode : held_back_.fit) {
    const int fitted = Part(episode.frames, kHorizon[0]);
    scored.push_back({episode.recording, std::min(fitted, episode.frames - 1), episode.frames});
  }
  return scored;
}

double ModelChoice::TrackError(const SpringMassSystem& system, const Candidate& candidate) const {
  double sum = 0;
  const std::vector<ScoredFrames> scored = JudgedBy();
  for (const ScoredFrames& frames : scored) {
    RolloutOptions options = FollowOptions(first(), candidate, options_).rollout;
    if (options.substeps == 0) {
      options.substeps =
          StableSubsteps(ComputeStabilityBound(system), 1 / frames.recording->fps, kStepSafety);
    }
    const auto rollout = RollOut(system, {frames.recording, frames.last}, options);
    if (rollout->diverged()) return kInfinity;
    sum += FramesError(rollout->positions(), frames);
  }
  return sum / static_cast<double>(std::max<std::size_t>(1, scored.size()));
}

bool ModelChoice::Step() {
  if (round_ == kRounds) return false;
  if (round_ < 2) {
    StepCommonFactors();
  } else {
    StepSprings();
  }
  return true;
}

void ModelChoice::StepCommonFactors() {
  ChosenModel& model = Current().model;
  if (model.start_substeps == 0) SearchStart(&model);
  if (iteration_ == 0) damping_ = 1e-2;
  const LevenbergMarquardtState factors =
      StepFactors(model, Shorten(held_back_.fit, kHorizon[round_]), options_, damping_);
  model.factors = factors.x;
  damping_ = factors.damping;
  status_ = fmt::format("{}, start values: {:.3f} mm", model.candidate.Label(),
                        1e3 * std::sqrt(3 * factors.mean_square));
  if (++iteration_ < kMostSteps[round_] && !factors.converged) return;
  FinishContender(model.System(first()));
}

void ModelChoice::StepSprings() {
  const ChosenModel& model = Current().model;
  const Parameters parameters = SpringFactors(model.System(first()), first());
  if (iteration_ == 0) {
    springs_ = Eigen::VectorXd::Zero(parameters.size());
    damping_ = 1e-3;
  }
  TrackProblem::Options follow = FollowOptions(first(), model.candidate, options_);
  follow.rollout.growth_limit = kInfinity;
  TrackProblem problem(parameters, held_back_.fit, follow);
  GaussNewtonOptions prior = SpringPrior(parameters);
  prior.conjugate_gradient_steps = kSpringSteps;
  const GaussNewtonState after =
      GaussNewtonStep(&problem, {springs_, damping_, mean_square_, false}, prior);
  springs_ = after.x;
  damping_ = after.damping;
  mean_square_ = after.mean_square;
  status_ = fmt::format("{}, single springs: {:.3f} mm", model.candidate.Label(),
                        1e3 * std::sqrt(3 * after.mean_square));
  if (++iteration_ < kMostSteps[round_] && !after.converged) return;
  FinishContender(parameters.Apply(springs_));
}

void ModelChoice::FinishContender(const SpringMassSystem& system) {
  Contender& contender = Current();
  contender.score = TrackError(system, contender.model.candidate);
  status_ = fmt::format("{}: {:.3f} mm on held-back frames", contender.model.candidate.Label(),
                        1e3 * contender.score);
  iteration_ = 0;
  if (++turn_ < static_cast<int>(round_order_.size())) return;
  ++round_;
  BeginRound();
}

void ModelChoice::BeginRound() {
  turn_ = iteration_ = 0;
  if (round_ == 0) {
    round_order_.resize(contenders_.size());
    std::iota(round_order_.begin(), round_order_.end(), 0);
    return;
  }
  const auto better = [&](int i, int j) { return contenders_[i].score < contenders_[j].score; };
  std::vector<int> next;
  if (round_ == 1) {  // of each neighbour count the better treatment of controllers
    for (int i : round_order_) {
      const bool same = !next.empty() && contenders_[next.back()].model.candidate.neighbours ==
                                             contenders_[i].model.candidate.neighbours;
      if (!same) {
        next.push_back(i);
      } else if (better(i, next.back())) {
        next.back() = i;
      }
    }
  } else {
    next = round_order_;
    std::stable_sort(next.begin(), next.end(), better);
    next.resize(std::min<std::size_t>(next.size(), round_ == 2 ? kFinalists : 1));
  }
  std::erase_if(next, [&](int i) { return !std::isfinite(contenders_[i].score); });
  if (next.empty()) {
    throw Error(fmt::format(
        "recording {}: the motion diverges with every start value tried{}", first().name,
        options_.substeps > 0 ? fmt::format("; {} sub-steps a frame are too few", options_.substeps)
                              : ", even with a stable sub-step; are its positions in metres?"));
  }
  std::sort(next.begin(), next.end());
  round_order_ = next;
  if (round_ == 2 && next.size() == 1) round_ = kRounds;  // there is nothing left to choose
}

double ModelChoice::Progress() const {
  if (round_ == kRounds) return 1;
  constexpr std::array<double, kRounds + 1> kStart = {0, 0.2, 0.6, 1};
  const double turns = (turn_ + static_cast<double>(iteration_) / kMostSteps[round_]) /
                       static_cast<double>(round_order_.size());
  return kStart[round_] + (kStart[round_ + 1] - kStart[round_]) * turns;
}

ChosenModel ModelChoice::Best() const {
  const auto best = std::min_element(round_order_.begin(), round_order_.end(), [&](int i, int j) {
    return contenders_[i].score < contenders_[j].score;
  });
  ChosenModel model = contenders_[*best].model;
  if (model.start_substeps == 0) SearchStart(&model);
  return model;
}

void ModelChoice::Save(StateArrays* arrays) const {
  std::vector<int> counters = {round_, turn_, iteration_};
  std::vector<int> in_round(contenders_.size(), 0);
  for (int i : round_order_) in_round[i] = 1;
  counters.insert(counters.end(), in_round.begin(), in_round.end());
  std::vector<double> numbers = {damping_, mean_square_};
  const auto add = [&](const Eigen::VectorXd& values) {
    numbers.push_back(static_cast<double>(values.size()));
    numbers.insert(numbers.end(), values.begin(), values.end());
  };
  add(springs_);
  for (const Contender& contender : contenders_) {
    numbers.insert(numbers.end(), {contender.score, contender.model.start_substeps});
    add(contender.model.factors);
  }
  (*arrays)["train/choice"] = StoreCounters(counters);
  (*arrays)["train/contenders"] = NpzArray::Doubles({numbers.size()}, numbers.data());
}

void ModelChoice::Load(const StateArrays& arrays) {
  const std::vector<int> counters = LoadCounters(arrays, "choice", 3 + contenders_.size());
  round_ = counters[0], turn_ = counters[1], iteration_ = counters[2];
  round_order_.clear();
  for (std::size_t i = 0; i < contenders_.size(); ++i) {
    if (counters[3 + i] != 0) round_order_.push_back(static_cast<int>(i));
  }
  const auto found = arrays.find("train/contenders");
  if (found == arrays.end()) {
    throw Error("cannot resume: array 'train/contenders' is missing");
  }
  const std::vector<double> numbers = found->second.ToDoubles();
  std::size_t at = 0;
  const auto next = [&] {
    if (at == numbers.size()) {
      throw Error(fmt::format("cannot resume: array 'train/contenders' ends after {} values", at));
    }
    return numbers[at++];
  };
  const auto next_vector = [&](Eigen::VectorXd* values) {
    const double size = next();
    if (!(size >= 0 && size <= static_cast<double>(numbers.size()))) {
      throw Error(fmt::format("cannot resume: array 'train/contenders' holds {} as a size", size));
    }
    values->resize(static_cast<Eigen::Index>(size));
    for (double& value : *values) value = next();
  };
  damping_ = next();
  mean_square_ = next();
  next_vector(&springs_);
  for (Contender& contender : contenders_) {
    contender.score = next();
    contender.model.start_substeps = next();
    next_vector(&contender.model.factors);
  }
}

}  // namespace physpring
