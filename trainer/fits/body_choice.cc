// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/body_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "trainer/bodies/candidates.h"
#include "trainer/bodies/hanging_net.h"
#include "trainer/data/held_back.h"
#include "trainer/motion/observer.h"
#include "trainer/motion/track_error.h"
#include "twin/error.h"
#include "twin/parallel.h"

namespace physpring {
namespace {

constexpr int kMostChoiceRecordings = 4;  // start values are sought on no more than these
// A round of the choice: under which of kObserverGains bodies are fitted, and how many go on from
// it. The last one compares nets of single springs with bodies of another kind.
struct Round {
  const char* name;
  double first_part, last_part;  // where it begins and ends in the choice's work
  int first_gain, last_gain;
  int most_steps;  // the most with each gain
  int left;
};
constexpr std::array<Round, 3> kRounds = {
    {{"far", 0, 0.5, 0, 1, 5, 3}, {"near", 0.5, 0.9, 2, 3, 6, 2}, {"springs", 0.9, 1, 3, 3, 6, 1}}};
constexpr const Round& kSpringRound = kRounds[2];
constexpr double kWorthMore = 0.95;  // more neighbours must lower the error to this share
constexpr double kHopeless = 1.1;    // nets so much worse than the best go no further
constexpr int kChoiceConjugateGradients = 20;
// Changes of the friction's factor that are tried (on a ground), and of an effect's.
constexpr std::array<double, 3> kFrictions = {0, -1, 1.2};
constexpr std::array<double, 3> kEffectChanges = {0, -2, 2};

// A candidate on its way through the rounds.
struct Contender {
  ChosenBody model;
  double score = kInfinity;  // its score in the last round it was in, m
};

// A contender in the middle of a round.
struct RoundState {
  Contender contender;
  int gain, iteration = 0;  // gain: an index of kObserverGains
  double damping = 0, mean_square = 0;
  Eigen::VectorXd springs = {};  // the springs' own values, in the last round

  template <class Visitor>
  void Visit(Visitor&& visit) {
    ChosenBody& model = contender.model;
    visit(model.body.stretch, model.start_substeps, model.start, model.factors, springs,
          contender.score, gain, iteration, damping, mean_square);
  }
};

// The bodies that a search begins from: of one that hangs, stretched by more and more.
std::vector<Body> StartsOf(const Body& body) {
  if (body.strain.size() == 0) return {body};
  std::vector<Body> starts(kStretches.size(), body);
  for (std::size_t i = 0; i < starts.size(); ++i) starts[i].stretch = kStretches[i];
  return starts;
}

// The factors that a search begins from.
std::vector<Eigen::VectorXd> Starts(const Parameters& factors, const BodyKind& kind) {
  std::vector<Eigen::VectorXd> starts;
  const int searched = kind.SearchedEffect(factors);
  for (double friction : kFrictions) {
    for (double change : kEffectChanges) {
      if (factors.friction() < 0 && friction != 0) continue;
      if (searched < 0 && change != 0) continue;
      Eigen::VectorXd x = Eigen::VectorXd::Zero(factors.size());
      if (factors.friction() >= 0) x[factors.friction()] = friction;
      if (searched >= 0) x[searched] = change;
      starts.push_back(x);
    }
  }
  return starts;
}

// A round that some contenders are in: what they are fitted to, and how they are judged.
class RoundOfChoice {
 public:
  RoundOfChoice(const Round& round, bool by_free_motions, const HeldBack& held_back,
                const Recording& first, const TrainOptions& options)
      : round_(round),
        by_free_motions_(by_free_motions),
        held_back_(held_back),
        first_(first),
        options_(options) {}

  // Takes a contender through the round; `threads` tells how many threads it may use now.
  Contender Run(const Contender& contender, const std::function<int()>& threads,
                const Work& work) const {
    const RoundState start{contender, round_.first_gain};
    const bool fits_springs = is_last() && contender.model.body.kind->has_single_springs();
    return work
        .Follow(start,
                [&](RoundState* state) {
                  TrainOptions options = options_;
                  options.threads = threads();
                  return fits_springs ? StepSprings(options, state)
                                      : StepCommonFactors(options, state);
                })
        .contender;
  }

 private:
  bool is_last() const { return &round_ == &kSpringRound; }
  // In the last round a body without single springs has free motions fitted, where others have
  // single springs.
  int LastGain(const Body& body) const {
    return !body.kind->has_single_springs() && is_last() ? kLastGain : round_.last_gain;
  }
  StepReport StepCommonFactors(const TrainOptions& options, RoundState* state) const;
  StepReport StepSprings(const TrainOptions& options, RoundState* state) const;
  StepReport Judge(const SpringMassSystem& system, RoundState* state) const;
  double TrackError(const SpringMassSystem& system, const Body& body, double gain) const;
  void SearchStart(ChosenBody* model) const;

  const Round& round_;
  bool by_free_motions_;  // whether a body in the round has no single springs
  const HeldBack& held_back_;
  const Recording& first_;
  const TrainOptions& options_;
};

// Takes the start system that predicts best among a few, from soft to stiff and from slippery to
// rough.
void RoundOfChoice::SearchStart(ChosenBody* model) const {
  double least = kInfinity;
  for (const Body& body : StartsOf(model->body)) {
    for (double substeps = kSoftestStart; substeps <= kStiffestStart; substeps *= 2) {
      const Parameters factors = ChosenBody{body, substeps, {}, {}}.ParametersOf(first_);
      MotionProblem::Options follow = FollowOptions(first_, body, options_);
      follow.rollout.observer_gain = kObserverGains[0];
      MotionProblem problem(factors, held_back_.FitEpisodes(), follow);
      const std::vector<Eigen::VectorXd> starts = Starts(factors, *body.kind);
      const auto residuals = problem.Residuals(starts);
      for (std::size_t i = 0; i < starts.size(); ++i) {
        const Eigen::VectorXd& x = starts[i];
        const auto& r = residuals[i];
        if (model->start_substeps == 0) *model = {body, substeps, x, x};
        if (!r || r->squaredNorm() >= least) continue;
        least = r->squaredNorm();
        *model = {body, substeps, x, x};
      }
    }
  }
}

// The error on held-back frames under an observer of this gain.
double RoundOfChoice::TrackError(const SpringMassSystem& system, const Body& body,
                                 double gain) const {
  RolloutOptions options = FollowOptions(first_, body, options_).rollout;
  options.observer_gain = gain;
  return GeometricTrackError(system, held_back_.JudgedEpisodes(), FrameUse::kHeld, options);
}

StepReport RoundOfChoice::StepCommonFactors(const TrainOptions& options, RoundState* state) const {
  ChosenBody& model = state->contender.model;
  if (model.start_substeps == 0) SearchStart(&model);
  if (state->iteration == 0) state->damping = 1e-2;
  const LevenbergMarquardtState factors = StepFactors(model, held_back_.FitEpisodes(), options,
                                                      kObserverGains[state->gain], state->damping);
  model.factors = factors.x;
  state->damping = factors.damping;
  ++state->iteration;
  const int gains = LastGain(model.body) - round_.first_gain + 1;
  const double of_gain = static_cast<double>(state->iteration) / round_.most_steps;
  StepReport report{false, (state->gain - round_.first_gain + of_gain) / gains,
                    fmt::format("{}, start values: {:.3f} mm", model.body.Label(),
                                PointMillimetres(factors.mean_square))};
  if (state->iteration < round_.most_steps && !factors.converged) return report;
  state->iteration = 0;
  if (++state->gain <= LastGain(model.body)) return report;
  return Judge(model.System(first_), state);
}

StepReport RoundOfChoice::StepSprings(const TrainOptions& options, RoundState* state) const {
  const ChosenBody& model = state->contender.model;
  const Parameters parameters = SpringFactors(model.System(first_), first_, *model.body.kind);
  Eigen::VectorXd& springs = state->springs;
  if (state->iteration == 0) {
    springs = Eigen::VectorXd::Zero(parameters.size());
    state->damping = 1e-3;
  }
  MotionProblem::Options follow = FollowOptions(first_, model.body, options);
  follow.rollout.growth_limit = kInfinity;
  follow.rollout.observer_gain = kObserverGains[state->gain];
  MotionProblem problem(parameters, held_back_.FitEpisodes(), follow);
  GaussNewtonOptions prior = SpringPrior(parameters);
  prior.conjugate_gradient_steps = kChoiceConjugateGradients;
  const GaussNewtonState before{springs, state->damping, state->mean_square, false};
  const GaussNewtonState after = GaussNewtonStep(&problem, before, prior);
  springs = after.x;
  state->damping = after.damping;
  state->mean_square = after.mean_square;
  const bool stuck = IsStuck(before, after, state->iteration == 0);
  if (++state->iteration < round_.most_steps && !stuck) {
    return {false, static_cast<double>(state->iteration) / round_.most_steps,
            fmt::format("{}, single springs: {:.3f} mm", model.body.Label(),
                        PointMillimetres(after.mean_square))};
  }
  return Judge(parameters.Apply(springs), state);
}

// The score of a contender that has been fitted.
StepReport RoundOfChoice::Judge(const SpringMassSystem& system, RoundState* state) const {
  const Body& body = state->contender.model.body;
  double& score = state->contender.score;
  const auto error = [&](int gain) { return TrackError(system, body, kObserverGains[gain]); };
  if (!is_last()) {
    score = error(round_.last_gain);
  } else if (by_free_motions_) {  // fitted to free motions, it follows an observer worse
    score = error(kLastGain);
  } else {  // bodies whose motions are chaotic do well only under an observer
    score = 0.5 * (error(round_.last_gain) + error(kLastGain));
  }
  StepReport report{true, 1,
                    fmt::format("{}: {:.3f} mm on held-back frames", body.Label(), 1e3 * score)};
  if (is_last()) score *= body.kind->handicap();
  return report;
}

// The contenders that go on after a round, in their old order: the best `most`, and none that is
// `hopeless` times worse than the best.
std::vector<Contender> Left(const std::vector<Contender>& all, int most, double hopeless) {
  std::vector<double> scores;
  for (const Contender& one : all) scores.push_back(one.score);
  std::sort(scores.begin(), scores.end());
  const double worst =
      std::min(hopeless * scores[0], scores[std::min<std::size_t>(all.size(), most) - 1]);
  std::vector<Contender> going_on;
  for (const Contender& one : all) {
    if (one.score <= worst && std::isfinite(one.score)) going_on.push_back(one);
  }
  return going_on;
}

// The contender of the least score; but a net of more neighbours has to be worth it.
const Contender& Best(const std::vector<Contender>& contenders) {
  const Contender* best = &contenders.at(0);
  for (const Contender& one : contenders) {
    const Body &body = one.model.body, &other = best->model.body;
    const bool costs_more = body.kind == other.kind && body.neighbours > other.neighbours;
    if (one.score < (costs_more ? kWorthMore : 1) * best->score) best = &one;
  }
  return *best;
}

void ExpectSome(const std::vector<Contender>& contenders, const Recording& first,
                const TrainOptions& options) {
  if (!contenders.empty()) return;
  throw Error(fmt::format(
      "recording {}: the motion diverges with every start value tried{}", first.name,
      options.substeps > 0 ? fmt::format("; {} sub-steps a frame are too few", options.substeps)
                           : ", even with a stable sub-step; are its positions in metres?"));
}

}  // namespace

ChosenBody ChooseBody(const FitData& data, const TrainOptions& asked, const Work& work) {
  const Recording& first = data.recordings.at(0);
  const FitData some = ShortMotions(data, kMostChoiceRecordings);
  const HeldBack held_back = HoldBack(some, kMostChoiceRecordings);
  TrainOptions options = asked;
  options.single_precision = true;
  std::vector<Contender> contenders;
  const std::vector<Body> candidates = CandidateBodies(first, options);
  for (const Body& body : candidates) {
    if (body.controller_velocity != candidates[0].controller_velocity) continue;
    contenders.push_back({{body, 0, {}, {}}});
  }
  StartSystem(first, contenders[0].model.body, kSoftestStart);  // throws where there is no body

  for (const Round& round : kRounds) {
    const bool by_free_motions =
        std::any_of(contenders.begin(), contenders.end(),
                    [](const auto& one) { return !one.model.body.kind->has_single_springs(); });
    if (&round == &kSpringRound && !by_free_motions) break;  // all are nets
    const RoundOfChoice in_round(round, by_free_motions, held_back, first, options);
    const Work of_round = work.Stretch(round.name, round.first_part, round.last_part);
    const int count = static_cast<int>(contenders.size());
    ParallelShared(count, options.threads, [&](int i, const std::function<int()>& threads) {
      contenders[i] = in_round.Run(contenders[i], threads, of_round.Item(i, count));
    });
    contenders = Left(contenders, round.left, by_free_motions ? kInfinity : kHopeless);
    ExpectSome(contenders, first, options);
    if (contenders.size() == 1) break;  // there is nothing left to choose
  }
  return Best(contenders).model;
}

}  // namespace physpring
