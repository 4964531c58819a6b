// SPDX-License-Identifier: Apache-2.0
#include "trainer/model_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "trainer/observer.h"
#include "trainer/parallel.h"
#include "trainer/track_error.h"
#include "twin/error.h"

namespace physpring {
namespace {

constexpr int kMostChoiceRecordings = 4;  // that start values are sought on
// Of each round: what is fitted under which of kObserverGains, and how many go on from it with
// either treatment of the controllers' velocity (what that is worth shows with single springs).
struct Round {
  int first_gain, last_gain;
  int most_steps;  // with each gain
  int left_of_each;
};
constexpr std::array<Round, 3> kRounds = {{{0, 1, 5, 3}, {2, 3, 6, 1}, {3, 3, 6, 1}}};
constexpr int kRoundCount = static_cast<int>(kRounds.size());
constexpr int kChoiceConjugateGradients = 20;
// Changes of the friction's factor that are tried (on a ground), and of the rigidity's (of a rod).
constexpr std::array<double, 3> kFrictions = {0, -1, 1.2};
constexpr std::array<double, 3> kRigidities = {0, -2, 2};
constexpr double kSimpler = 0.9;  // a chain has a tenth of the others' parameters: a tie is its
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The factors that a search begins from.
std::vector<Eigen::VectorXd> Starts(const Parameters& factors) {
  std::vector<Eigen::VectorXd> starts;
  for (double friction : kFrictions) {
    for (double rigidity : kRigidities) {
      if (factors.friction() < 0 && friction != 0) continue;
      if (factors.effect_count() == 0 && rigidity != 0) continue;
      Eigen::VectorXd x = Eigen::VectorXd::Zero(factors.size());
      if (factors.friction() >= 0) x[factors.friction()] = friction;
      if (factors.effect_count() > 0) x[factors.effects()] = rigidity;  // a chain's first
      starts.push_back(x);
    }
  }
  return starts;
}

}  // namespace

ModelChoice::ModelChoice(const FitData& data, const TrainOptions& options)
    : data_(data), options_(options), held_back_(HoldBack(data, kMostChoiceRecordings)) {
  options_.single_precision = true;
  for (const Candidate& candidate : Candidates(first(), options)) {
    contenders_.push_back({{candidate, 0, {}, {}}, kInfinity});
  }
  in_round_.resize(contenders_.size());
  std::iota(in_round_.begin(), in_round_.end(), 0);
  StartSystem(first(), contenders_[0].model.candidate,
              kSoftestStart);  // throws where there is no body
}

// Among a few start systems from soft to stiff, slippery to rough, the one that predicts best.
void ModelChoice::SearchStart(ChosenModel* model) const {
  double least = kInfinity;
  for (double substeps = kSoftestStart; substeps <= kStiffestStart; substeps *= 2) {
    const Parameters factors = ChosenModel{model->candidate, substeps, {}, {}}.Factors(first());
    MotionProblem::Options follow = FollowOptions(first(), model->candidate, options_);
    follow.rollout.observer_gain = kObserverGains[0];
    MotionProblem problem(factors, held_back_.FitEpisodes(), follow);
    for (const Eigen::VectorXd& x : Starts(factors)) {
      if (model->start_substeps == 0) *model = {model->candidate, substeps, x, x};
      const auto r = problem.Residuals(x);
      if (!r || r->squaredNorm() >= least) continue;
      least = r->squaredNorm();
      *model = {model->candidate, substeps, x, x};
    }
  }
}

// Of held-back frames, under an observer of this gain.
double ModelChoice::TrackError(const SpringMassSystem& system, const Candidate& candidate,
                               double gain) const {
  RolloutOptions options = FollowOptions(first(), candidate, options_).rollout;
  options.observer_gain = gain;
  return GeometricTrackError(system, held_back_.JudgedEpisodes(), options);
}

// Contenders do not depend on each other: the first that have not finished their round go a step,
// each with its share of the threads.
bool ModelChoice::Step() {
  if (round_ == kRoundCount) return false;
  std::vector<int> running = in_round_;
  std::erase_if(running, [this](int i) { return contenders_[i].finished; });
  ParallelFirst(running, options_.threads, [this](int i, int threads) {
    TrainOptions options = options_;
    options.threads = threads;
    StepContender(options, &contenders_[i]);
  });
  status_ = contenders_[running[0]].status;
  if (std::all_of(in_round_.begin(), in_round_.end(),
                  [this](int i) { return contenders_[i].finished; })) {
    BeginNextRound();
  }
  return true;
}

bool ModelChoice::IsChainInRound() const {
  return std::any_of(in_round_.begin(), in_round_.end(),
                     [this](int i) { return contenders_[i].model.candidate.is_chain(); });
}

// In the last round a chain has free motions fitted, where others have single springs.
int ModelChoice::LastGain(const Candidate& candidate) const {
  return candidate.is_chain() && round_ == kRoundCount - 1 ? kLastGain : kRounds[round_].last_gain;
}

void ModelChoice::StepContender(const TrainOptions& options, Contender* contender) const {
  if (round_ < kRoundCount - 1 || contender->model.candidate.is_chain()) {
    StepCommonFactors(options, contender);
  } else {
    StepSprings(options, contender);
  }
}

void ModelChoice::StepCommonFactors(const TrainOptions& options, Contender* contender) const {
  ChosenModel& model = contender->model;
  if (model.start_substeps == 0) SearchStart(&model);
  if (contender->iteration == 0) contender->damping = 1e-2;
  const LevenbergMarquardtState factors =
      StepFactors(model, held_back_.FitEpisodes(), options, kObserverGains[contender->gain],
                  contender->damping);
  model.factors = factors.x;
  contender->damping = factors.damping;
  contender->status = fmt::format("{}, start values: {:.3f} mm", model.candidate.Label(),
                                  1e3 * std::sqrt(3 * factors.mean_square));
  if (++contender->iteration < kRounds[round_].most_steps && !factors.converged) return;
  contender->iteration = 0;
  if (++contender->gain <= LastGain(model.candidate)) return;
  FinishContender(model.System(first()), contender);
}

void ModelChoice::StepSprings(const TrainOptions& options, Contender* contender) const {
  const ChosenModel& model = contender->model;
  const Parameters parameters =
      SpringFactors(model.System(first()), first(), model.candidate.free_effects);
  if (contender->iteration == 0) {
    contender->springs = Eigen::VectorXd::Zero(parameters.size());
    contender->damping = 1e-3;
  }
  MotionProblem::Options follow = FollowOptions(first(), model.candidate, options);
  follow.rollout.growth_limit = kInfinity;
  follow.rollout.observer_gain = kObserverGains[contender->gain];
  MotionProblem problem(parameters, held_back_.FitEpisodes(), follow);
  GaussNewtonOptions prior = SpringPrior(parameters);
  prior.conjugate_gradient_steps = kChoiceConjugateGradients;
  const GaussNewtonState before{contender->springs, contender->damping, contender->mean_square,
                                false};
  const GaussNewtonState after = GaussNewtonStep(&problem, before, prior);
  contender->springs = after.x;
  contender->damping = after.damping;
  contender->mean_square = after.mean_square;
  contender->status = fmt::format("{}, single springs: {:.3f} mm", model.candidate.Label(),
                                  1e3 * std::sqrt(3 * after.mean_square));
  const bool stuck = IsStuck(before, after, contender->iteration == 0);
  if (++contender->iteration < kRounds[round_].most_steps && !stuck) return;
  FinishContender(parameters.Apply(contender->springs), contender);
}

void ModelChoice::FinishContender(const SpringMassSystem& system, Contender* contender) const {
  const Candidate& candidate = contender->model.candidate;
  const auto error = [&](int gain) { return TrackError(system, candidate, kObserverGains[gain]); };
  const int gain = kRounds[round_].last_gain;
  if (round_ < kRoundCount - 1) {
    contender->score = error(gain);
  } else if (IsChainInRound()) {  // fitted to free motions, it follows an observer worse
    contender->score = error(kLastGain);
  } else {  // bodies whose motions are chaotic do well only under an observer
    contender->score = 0.5 * (error(gain) + error(kLastGain));
  }
  contender->status =
      fmt::format("{}: {:.3f} mm on held-back frames", candidate.Label(), 1e3 * contender->score);
  if (round_ == kRoundCount - 1 && candidate.is_chain()) contender->score *= kSimpler;
  contender->finished = true;
}

void ModelChoice::BeginNextRound() {
  const int left_of_each = kRounds[round_].left_of_each;
  ++round_;
  const auto better = [&](int i, int j) { return contenders_[i].score < contenders_[j].score; };
  std::vector<int> next = in_round_;
  std::stable_sort(next.begin(), next.end(), better);
  if (round_ == kRoundCount) {
    next.resize(1);
  } else {
    std::array<int, 2> left = {};  // with and without velocity
    std::erase_if(next, [&](int i) {
      const bool velocity = contenders_[i].model.candidate.controller_velocity;
      return ++left[velocity ? 0 : 1] > left_of_each;
    });
  }
  std::erase_if(next, [&](int i) { return !std::isfinite(contenders_[i].score); });
  if (next.empty()) {
    throw Error(fmt::format(
        "recording {}: the motion diverges with every start value tried{}", first().name,
        options_.substeps > 0 ? fmt::format("; {} sub-steps a frame are too few", options_.substeps)
                              : ", even with a stable sub-step; are its positions in metres?"));
  }
  std::sort(next.begin(), next.end());
  in_round_ = next;
  if (next.size() == 1) round_ = kRoundCount;  // there is nothing left to choose
  if (round_ == kRoundCount) return;
  for (int i : in_round_) {
    contenders_[i].finished = false;
    contenders_[i].gain = kRounds[round_].first_gain;
    contenders_[i].iteration = 0;
  }
}

double ModelChoice::PartOfRound(const Contender& contender) const {
  if (contender.finished) return 1;
  const Round& round = kRounds[round_];
  const int gains = LastGain(contender.model.candidate) - round.first_gain + 1;
  return (contender.gain - round.first_gain +
          static_cast<double>(contender.iteration) / round.most_steps) /
         gains;
}

double ModelChoice::Progress() const {
  if (round_ == kRoundCount) return 1;
  constexpr std::array<double, kRounds.size() + 1> kStart = {0, 0.5, 0.9, 1};
  double part = 0;
  for (int i : in_round_) part += PartOfRound(contenders_[i]);
  part /= static_cast<double>(in_round_.size());
  return kStart[round_] + (kStart[round_ + 1] - kStart[round_]) * part;
}

int ModelChoice::BestContender() const {
  return *std::min_element(in_round_.begin(), in_round_.end(), [&](int i, int j) {
    return contenders_[i].score < contenders_[j].score;
  });
}

ChosenModel ModelChoice::Best() const {
  ChosenModel model = contenders_[BestContender()].model;
  if (model.start_substeps == 0) SearchStart(&model);
  return model;
}

void ModelChoice::Save(StateArrays* arrays) const {
  std::vector<int> counters = {round_};
  std::vector<double> numbers;
  const auto add = [&](const Eigen::VectorXd& values) {
    numbers.push_back(static_cast<double>(values.size()));
    numbers.insert(numbers.end(), values.begin(), values.end());
  };
  for (std::size_t i = 0; i < contenders_.size(); ++i) {
    const Contender& contender = contenders_[i];
    const bool in_round =
        std::find(in_round_.begin(), in_round_.end(), static_cast<int>(i)) != in_round_.end();
    counters.insert(counters.end(),
                    {in_round, contender.finished, contender.gain, contender.iteration});
    numbers.insert(numbers.end(), {contender.score, contender.damping, contender.mean_square,
                                   contender.model.start_substeps});
    add(contender.model.start);
    add(contender.model.factors);
    add(contender.springs);
  }
  (*arrays)["train/choice"] = StoreCounters(counters);
  (*arrays)["train/contenders"] = NpzArray::Doubles({numbers.size()}, numbers.data());
}

void ModelChoice::Load(const StateArrays& arrays) {
  const std::vector<int> counters = LoadCounters(arrays, "choice", 1 + 4 * contenders_.size());
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
  round_ = counters[0];
  in_round_.clear();
  for (std::size_t i = 0; i < contenders_.size(); ++i) {
    Contender& contender = contenders_[i];
    const int* counter = &counters[1 + 4 * i];
    if (counter[0] != 0) in_round_.push_back(static_cast<int>(i));
    contender.finished = counter[1] != 0;
    contender.gain = counter[2];
    contender.iteration = counter[3];
    contender.score = next();
    contender.damping = next();
    contender.mean_square = next();
    contender.model.start_substeps = next();
    next_vector(&contender.model.start);
    next_vector(&contender.model.factors);
    next_vector(&contender.springs);
  }
}

}  // namespace physpring
