// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/fitting.h"

#include <algorithm>
#include <utility>

#include "trainer/bodies/factors.h"
#include "trainer/bodies/spring_net.h"
#include "trainer/bodies/start_system.h"
#include "trainer/motion/observer.h"
#include "trainer/solvers/levenberg_marquardt.h"
#include "twin/parallel.h"
#include "twin/stability.h"

namespace physpring {
namespace {

// The range of common factors that hardly move (their logarithms). What a training on other
// recordings found may be wrong by a quarter, but an effect that does the opposite must not undo
// it.
constexpr EffectModel::OwnRange kTrusted{0.05, 0.25};
constexpr double kMostCommonRate = 5000;  // sub-steps a second at most
constexpr int kUpdates = 4;               // of the Jacobian of a smooth body, in a step
// An exact fit ends where a step gains less than this part.
constexpr double kExactTolerance = 5e-4;
// A body as it was trained may take so many times the sub-steps a second that it came with.
constexpr double kTrainedRoom = 1.25;

// The state of either method as one vector, and back.
template <class State>
Eigen::VectorXd Pack(const State& state) {
  Eigen::VectorXd packed(state.x.size() + 3);
  packed << state.x, state.damping, state.mean_square, state.converged ? 1 : 0;
  return packed;
}

template <class State>
void Unpack(const Eigen::VectorXd& packed, State* state) {
  const Eigen::Index size = packed.size() - 3;
  state->x = packed.head(size);
  state->damping = packed[size];
  state->mean_square = packed[size + 1];
  state->converged = packed[size + 2] != 0;
}

}  // namespace

void ScorePrediction(const std::vector<SplitRecording>& recordings,
                     const std::vector<std::vector<Points>>& predicted, Verdict* verdict) {
  verdict->held = TrackOf(recordings, predicted, SplitRecording::Use::kHeld);
  verdict->track = {Mean(TrackOf(recordings, predicted, SplitRecording::Use::kFit)),
                    Mean(verdict->held)};
}

PieceKey KeyOf(const std::string& kind, const Hypothesis& hypothesis) {
  PieceKey key(kind);
  if (hypothesis.material) key.Add("smooth").Add(hypothesis.material->from);
  return key.Add(static_cast<double>(hypothesis.body))
      .Add(hypothesis.start_substeps)
      .Add(hypothesis.effects);
}

Fitting::Fitting(std::vector<DiagnosisBody> bodies, std::vector<SplitRecording> recordings,
                 int threads, Journal* journal, std::size_t lasting_effects)
    : bodies_(std::move(bodies)),
      recordings_(std::move(recordings)),
      threads_(threads),
      journal_(journal),
      lasting_effects_(lasting_effects) {
  for (const SplitRecording& split : recordings_) followed_.push_back(DropHeldOut(split));
}

double Fitting::difference() const { return FactorDifference(*recordings_[0].recording); }

double Fitting::MostRate(std::size_t body) const {
  if (bodies_[body].kind == DiagnosisBody::Kind::kOpen) return kMostCommonRate;
  const SpringMassSystem& base = bodies_[body].base;
  const double own =
      DiagnosisRate(base, recordings_[0].recording->fps) * CostOf(base.dashpot_stages);
  return std::max(kMostCommonRate, kTrainedRoom * own);
}

SpringMassSystem Fitting::Base(std::size_t body, double start_substeps) const {
  SpringMassSystem base = bodies_[body].base;
  if (bodies_[body].kind == DiagnosisBody::Kind::kOpen) {
    ScaleToSubsteps(1 / recordings_[0].recording->fps, start_substeps, kStepSafety, &base);
  }
  return base;
}

Descent Fitting::Begin(std::size_t body, const std::vector<EffectValues>& effects) const {
  Descent best;
  for (double substeps = kSoftestStart; substeps <= kStiffestStart; substeps *= 2) {
    Descent descent{{body, effects, substeps}, {}};
    const EffectModel model = Model(descent.hypothesis);
    descent.x = Eigen::VectorXd::Zero(model.size());
    EffectProblem problem = MakeProblem(model, body, kObserverGains[0], Care::kRough);
    if (!problem.FixSubsteps(descent.x)) continue;
    const auto r = problem.Residuals(descent.x);
    if (!r || r->squaredNorm() >= best.misfit) continue;
    descent.misfit = r->squaredNorm();
    best = std::move(descent);
    if (bodies_[body].kind != DiagnosisBody::Kind::kOpen) break;
  }
  return best;
}

Descent Fitting::Smooth(const Descent& fit, SmoothBody::Numbers numbers) const {
  const EffectModel model = Model(fit.hypothesis);
  const Eigen::Index own = fit.x.size() - model.effect_size();
  SpringMassSystem start = model.Apply(fit.x);
  Descent smooth = fit;
  const auto added = start.effects.end() - static_cast<long>(fit.hypothesis.effects.size());
  smooth.hypothesis.effects.assign(added, start.effects.end());
  start.effects.erase(added, start.effects.end());
  start.dashpot = start.stiffness * (start.dashpot.sum() / start.stiffness.sum());  // one loss time
  SmoothBody::Options options{MostRate(fit.hypothesis.body)};
  options.numbers = numbers;
  options.class_loss_times = numbers == SmoothBody::Numbers::kAll;
  const SmoothBody body(start, *recordings_[0].recording, SpringNet(), options);
  Eigen::VectorXd from = fit.x.head(own);
  if (fit.hypothesis.material) {
    const Eigen::VectorXd& before = fit.hypothesis.material->from;
    from.resize(before.size() + own);
    from << before, fit.x.head(own);
  }
  smooth.hypothesis.material = {from, std::make_shared<const SmoothBody>(body)};
  smooth.x = Eigen::VectorXd::Zero(body.size() + model.effect_size());
  return smooth;
}

EffectModel Fitting::Model(const Hypothesis& hypothesis) const {
  if (hypothesis.material) return EffectModel(hypothesis.material->body, hypothesis.effects);
  const DiagnosisBody& body = bodies_[hypothesis.body];
  return EffectModel(
      CommonFactors(Base(hypothesis.body, hypothesis.start_substeps), *recordings_[0].recording),
      body.kind == DiagnosisBody::Kind::kTrusted ? kTrusted : EffectModel::OwnRange{},
      hypothesis.effects);
}

EffectProblem Fitting::Problem(const Hypothesis& hypothesis, double gain, Care care) const {
  return MakeProblem(Model(hypothesis), hypothesis.body, gain, care);
}

EffectProblem Fitting::MakeProblem(const EffectModel& model, std::size_t body, double gain,
                                   Care care) const {
  EffectProblem::Options options;
  options.lasting_effects = lasting_effects_;
  options.least_rate = kLeastDiagnosisRate;
  options.most_rate = MostRate(body);
  options.rollout.controller_velocity = bodies_[body].controller_velocity;
  options.rollout.single_precision = care == Care::kRough;
  options.difference =
      DirectionDifference(*recordings_[0].recording, options.rollout.single_precision);
  options.rollout.observer_gain = gain;
  return EffectProblem(model, gain > 0 ? followed_ : recordings_, options);
}

bool Fitting::DescendOne(double gain, Care care, int steps, int threads, Descent* descent) const {
  EffectProblem problem = Problem(descent->hypothesis, gain, care);
  LevenbergMarquardtOptions options;
  options.difference = difference();
  options.threads = threads;
  if (descent->hypothesis.material) options.updates = kUpdates;
  if (care == Care::kExact) options.tolerance = kExactTolerance;
  LevenbergMarquardtState state;
  state.x = descent->x;
  state.damping = descent->damping;
  for (int step = 0; step < steps && !state.converged; ++step) {
    PieceKey key = KeyOf("Levenberg-Marquardt", descent->hypothesis);
    const Eigen::VectorXd after = journal().Get(
        key.Add(gain).Add(care == Care::kExact ? 1.0 : 0.0).Add(state.x).Add(state.damping), [&] {
          if (!problem.FixSubsteps(state.x)) return Eigen::VectorXd();
          options.precisions = problem.model().Precision(state.x);
          return Pack(LevenbergMarquardtStep(ResidualsOf(problem), state, options));
        });
    if (after.size() == 0) return false;
    Unpack(after, &state);
  }
  if (!(state.mean_square > 0)) return false;
  descent->x = state.x;
  descent->damping = state.damping;
  descent->misfit = state.mean_square;
  descent->converged = state.converged;
  return true;
}

void Fitting::Descend(double gain, Care care, int steps, std::vector<Descent>* descents) const {
  const auto count = static_cast<int>(descents->size());
  const int each = std::max(1, threads_ / std::max(1, count));
  std::vector<char> good(descents->size(), 0);
  ParallelFor(count, threads_, [&](int i) {
    const auto n = static_cast<std::size_t>(i);
    good[n] = DescendOne(gain, care, steps, each, &(*descents)[n]) ? 1 : 0;
  });
  std::vector<Descent> kept;
  for (std::size_t n = 0; n < descents->size(); ++n) {
    if (good[n] != 0) kept.push_back(std::move((*descents)[n]));
  }
  *descents = std::move(kept);
}

std::optional<Verdict> Fitting::JudgeAt(EffectProblem* problem, const Eigen::VectorXd& x,
                                        const Descent& descent) const {
  if (!problem->FixSubsteps(x)) return {};
  const auto predicted = problem->Predict(x);
  if (!predicted) return {};
  Verdict verdict;
  verdict.descent = descent;
  verdict.system = problem->SystemAt(x);
  verdict.controller_velocity = bodies_[descent.hypothesis.body].controller_velocity;
  ScorePrediction(recordings_, *predicted, &verdict);
  return verdict;
}

std::optional<Verdict> Fitting::Judge(const Descent& descent) const {
  EffectProblem problem = Problem(descent.hypothesis, 0, Care::kExact);
  return JudgeAt(&problem, descent.x, descent);
}

std::vector<Verdict> Fitting::JudgeAll(const std::vector<Descent>& descents) const {
  std::vector<std::optional<Verdict>> judged(descents.size());
  ParallelFor(static_cast<int>(descents.size()), threads_, [&](int i) {
    const auto n = static_cast<std::size_t>(i);
    judged[n] = Judge(descents[n]);
  });
  std::vector<Verdict> verdicts;
  for (std::optional<Verdict>& verdict : judged) {
    if (verdict) verdicts.push_back(std::move(*verdict));
  }
  return verdicts;
}

}  // namespace physpring
