// SPDX-License-Identifier: Apache-2.0
#include "trainer/diagnosis/effect_fit.h"

#include <algorithm>
#include <utility>

#include "trainer/factors.h"
#include "trainer/gauss_newton.h"
#include "trainer/levenberg_marquardt.h"
#include "trainer/observer.h"
#include "trainer/parallel.h"
#include "trainer/start_system.h"
#include "twin/stability.h"

namespace physpring {
namespace {

// Of common factors that hardly move (their logarithms): what a training on other recordings found
// may be wrong by a quarter, but not be undone by an effect that does the opposite.
constexpr EffectModel::OwnRange kTrusted{0.05, 0.25};
constexpr int kSpringConjugateGradients = 20;
constexpr double kEffectScale = 30;  // of an effect's parameters beside the springs' own

// Of single springs, first under an observer with this gain.
constexpr double kFollowedGain = 0.05;
constexpr int kFollowedSpringSteps = 3;

// Sub-steps a second at most, as in training: common factors leave room for single springs.
constexpr double kMostRate = 10000, kMostCommonRate = 5000;
constexpr double kTrustedRoom = 1.25;  // above what a trusted body takes as it came

// Calls `work` for each fit and takes out those for which it returns false.
template <class Work>
void ForEach(int threads, std::vector<EffectFit>* fits, Work work) {
  std::vector<char> good(fits->size(), 0);
  ParallelFor(static_cast<int>(fits->size()), threads, [&](int i) {
    const auto n = static_cast<std::size_t>(i);
    good[n] = work(&(*fits)[n]) ? 1 : 0;
  });
  std::vector<EffectFit> kept;
  for (std::size_t n = 0; n < fits->size(); ++n) {
    if (good[n] != 0) kept.push_back(std::move((*fits)[n]));
  }
  *fits = std::move(kept);
}

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

// The trainer's, and for the effects the one of Levenberg-Marquardt.
GaussNewtonOptions Prior(const EffectModel& model) {
  GaussNewtonOptions options = SpringPrior(model.own());
  options.conjugate_gradient_steps = kSpringConjugateGradients;
  const auto append = [&](double value, Eigen::VectorXd* values) {
    const Eigen::Index own = values->size();
    values->conservativeResize(model.size());
    values->tail(model.size() - own).setConstant(value);
  };
  append(kDiagnosisPrecision, &options.precision);
  append(kEffectScale, &options.scale);
  return options;
}

}  // namespace

void ScorePrediction(const std::vector<SplitRecording>& recordings,
                     const std::vector<std::vector<Points>>& predicted, EffectFit* fit) {
  fit->held = TrackOf(recordings, predicted, SplitRecording::Use::kHeld);
  fit->track = {Mean(TrackOf(recordings, predicted, SplitRecording::Use::kFit)), Mean(fit->held)};
}

PieceKey KeyOf(const std::string& kind, const EffectFit& fit) {
  PieceKey key(kind);
  if (fit.trained) key.Add("trained");
  return key.Add(static_cast<double>(fit.body)).Add(fit.start_substeps).Add(fit.start);
}

EffectFitting::EffectFitting(std::vector<DiagnosisBody> bodies,
                             std::vector<SplitRecording> recordings, int threads, Journal* journal)
    : bodies_(std::move(bodies)),
      recordings_(std::move(recordings)),
      threads_(threads),
      journal_(journal) {
  for (const SplitRecording& split : recordings_) followed_.push_back(DropHeldOut(split));
}

double EffectFitting::difference() const { return FactorDifference(*recordings_[0].recording); }

SpringMassSystem EffectFitting::Base(std::size_t body, double start_substeps) const {
  SpringMassSystem base = bodies_[body].base;
  if (!bodies_[body].trusted) {
    ScaleToSubsteps(1 / recordings_[0].recording->fps, start_substeps, kStepSafety, &base);
  }
  return base;
}

EffectFit EffectFitting::Begin(std::size_t body, const std::vector<EffectValues>& effects) const {
  EffectFit best;
  for (double substeps = kSoftestStart; substeps <= kStiffestStart; substeps *= 2) {
    EffectFit fit;
    fit.body = body;
    fit.start = effects;
    fit.start_substeps = substeps;
    const EffectModel model = Model(fit);
    fit.x = Eigen::VectorXd::Zero(model.size());
    EffectProblem problem = MakeProblem(model, bodies_[body], kObserverGains[0], 1);
    if (!problem.FixSubsteps(fit.x)) continue;
    const auto r = problem.Residuals(fit.x);
    if (!r || r->squaredNorm() >= best.misfit) continue;
    fit.misfit = r->squaredNorm();
    best = std::move(fit);
    if (bodies_[body].trusted) break;
  }
  return best;
}

EffectModel EffectFitting::Model(const EffectFit& fit) const {
  const DiagnosisBody& body = bodies_[fit.body];
  return EffectModel(CommonFactors(Base(fit.body, fit.start_substeps), *recordings_[0].recording),
                     body.trusted ? kTrusted : EffectModel::OwnRange{}, fit.start);
}

EffectProblem EffectFitting::Problem(const EffectFit& fit, double gain) const {
  return MakeProblem(Model(fit), bodies_[fit.body], gain, 1);
}

EffectProblem EffectFitting::MakeProblem(const EffectModel& model, const DiagnosisBody& body,
                                         double gain, int threads) const {
  EffectProblem::Options options;
  options.threads = threads;
  options.limit_dashpots = model.own().kind(model.own().size() - 1) == Parameters::Kind::kGlobal;
  options.least_rate = kLeastDiagnosisRate;
  options.most_rate = options.limit_dashpots ? kMostCommonRate : kMostRate;
  if (body.trusted) {
    const double own = DiagnosisRate(body.base, recordings_[0].recording->fps);
    options.most_rate = std::max(options.most_rate, kTrustedRoom * own);
  }
  options.rollout.controller_velocity = body.controller_velocity;
  // an observer is for finding the way, which needs fewer digits
  options.rollout.single_precision = gain > 0;
  options.difference =
      DirectionDifference(*recordings_[0].recording, options.rollout.single_precision);
  options.rollout.observer_gain = gain;
  return EffectProblem(model, gain > 0 ? followed_ : recordings_, options);
}

bool EffectFitting::DescendOne(double gain, int steps, int threads, EffectFit* fit) const {
  EffectProblem problem = Problem(*fit, gain);
  LevenbergMarquardtOptions options;
  options.difference = difference();
  options.threads = threads;
  LevenbergMarquardtState state;
  state.x = fit->x;
  state.damping = fit->damping;
  for (int step = 0; step < steps && !state.converged; ++step) {
    PieceKey key = KeyOf("Levenberg-Marquardt", *fit);
    const Eigen::VectorXd after = journal().Get(key.Add(gain).Add(state.x).Add(state.damping), [&] {
      if (!problem.FixSubsteps(state.x)) return Eigen::VectorXd();
      return Pack(LevenbergMarquardtStep(
          [&](const Eigen::VectorXd& at) { return problem.Residuals(at); }, state, options));
    });
    if (after.size() == 0) return false;
    Unpack(after, &state);
  }
  if (!(state.mean_square > 0)) return false;
  fit->x = state.x;
  fit->damping = state.damping;
  fit->misfit = state.mean_square;
  fit->converged = state.converged;
  return true;
}

void EffectFitting::Descend(double gain, int steps, std::vector<EffectFit>* fits) const {
  const int each = std::max(1, threads_ / std::max(1, static_cast<int>(fits->size())));
  ForEach(threads_, fits, [&](EffectFit* fit) { return DescendOne(gain, steps, each, fit); });
}

bool EffectFitting::Predict(EffectProblem* problem, const Eigen::VectorXd& x,
                            EffectFit* fit) const {
  if (!problem->FixSubsteps(x)) return false;
  const auto predicted = problem->Predict(x);
  if (!predicted) return false;
  fit->system = problem->SystemAt(x);
  fit->controller_velocity = bodies_[fit->body].controller_velocity;
  ScorePrediction(recordings_, *predicted, fit);
  return true;
}

bool EffectFitting::Judge(EffectFit* fit) const {
  EffectProblem problem = Problem(*fit, 0);
  return Predict(&problem, fit->x, fit);
}

void EffectFitting::JudgeAll(std::vector<EffectFit>* fits) const {
  ForEach(threads_, fits, [&](EffectFit* fit) { return Judge(fit); });
}

void EffectFitting::RefitSprings(int steps, EffectFit* fit) const {
  SpringMassSystem base = fit->system;
  base.effects.clear();
  const EffectModel model(SpringFactors(base, *recordings_[0].recording), {}, fit->system.effects);
  const GaussNewtonOptions prior = Prior(model);
  GaussNewtonState state;
  state.x = Eigen::VectorXd::Zero(model.size());
  for (const bool followed : {true, false}) {
    const double gain = followed ? kFollowedGain : 0;
    EffectProblem problem = MakeProblem(model, bodies_[fit->body], gain, threads_);
    state.damping = 1e-3;
    state.converged = false;
    int slow = 0;
    for (int step = 0; step < (followed ? kFollowedSpringSteps : steps); ++step) {
      const GaussNewtonState before = state;
      PieceKey key = KeyOf("Gauss-Newton", *fit);
      const Eigen::VectorXd after =
          journal().Get(key.Add(fit->x).Add(gain).Add(state.x).Add(state.damping),
                        [&] { return Pack(GaussNewtonStep(&problem, state, prior)); });
      Unpack(after, &state);
      slow = step > 0 && state.mean_square > kSlowStep * before.mean_square ? slow + 1 : 0;
      if (slow == kMostSlowSteps || IsStuck(before, state, step == 0)) break;
    }
  }
  EffectProblem problem = MakeProblem(model, bodies_[fit->body], 0, threads_);
  EffectFit refitted = *fit;
  if (Predict(&problem, state.x, &refitted)) *fit = std::move(refitted);
}

}  // namespace physpring
