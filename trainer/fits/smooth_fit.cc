// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/smooth_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace physpring {
namespace {

// A rough fit ends where a step gains less than this part of the objective.
constexpr double kRoughTolerance = 2e-3;
constexpr int kMostRoughSteps = 40, kMostSteps = 80;  // with each gain
constexpr int kUpdates = 4;                           // of the Jacobian in a step
constexpr double kSmoothDamping = 1e-2;               // the damping with which each stage begins

// A stage of a fit: under an observer of this gain, and how far down.
struct Stage {
  enum class Depth {
    kRough,  // not to the end
    kEnd,
    kBottom  // all that is compared has one number of sub-steps, as the last steps want
  };
  double gain;
  Depth depth;
};
using Course = std::vector<Stage>;

struct SmoothState {
  Eigen::VectorXd x;
  int stage = 0;                    // of the course
  int iteration = 0;                // steps made in this stage
  double damping = kSmoothDamping;  // of the next step
  double least_rate = 0;            // sub-steps a second, at the bottom

  template <class Visitor>
  void Visit(Visitor&& visit) {
    visit(x, stage, iteration, damping, least_rate);
  }
};

// The chosen start, with one loss time for all springs and the contact as chosen.
SpringMassSystem StartOf(const ChosenBody& chosen, const Recording& recording) {
  SpringMassSystem start = StartSystem(recording, chosen.body, chosen.start_substeps);
  start.dashpot = start.stiffness * (start.dashpot.sum() / start.stiffness.sum());
  start.contact = chosen.System(recording).contact;
  return start;
}

// Numbers of a body whose springs that are longer are soft, by whole classes of length.
Eigen::VectorXd SoftBeyond(double length, const SmoothBody& body) {
  constexpr double kSoft = -4;  // a logarithm: two deviations of the prior
  Eigen::VectorXd x = Eigen::VectorXd::Zero(body.size());
  const Parameters& factors = body.factors();
  for (int e = 0; e < factors.base().spring_count(); ++e) {
    if (factors.base().rest_length[e] <= length) continue;
    x[factors.first_class() + factors.classes().of_spring[static_cast<std::size_t>(e)]] = kSoft;
  }
  return x;
}

// What is fitted, and to what.
class SmoothFit {
 public:
  SmoothFit(const SmoothBody& body, const ChosenBody& chosen, const std::vector<Episode>& episodes,
            const TrainOptions& options, const Course& course = {})
      : body_(body),
        chosen_(chosen),
        episodes_(episodes),
        options_(options),
        course_(course),
        recording_(OnlyFitFrames(episodes.at(0))) {}

  StepReport Step(SmoothState* state) const;
  std::optional<LinearisedFit> LineariseAt(const Eigen::VectorXd& x) const;

 private:
  MotionProblem::Options Follow(const Stage& stage) const;
  // Whether in doubles, with derivatives that are exact enough for the last steps. Under an
  // observer they need not be. Over a ground they are only at the bottom.
  bool IsExact(const Stage& stage) const {
    return stage.depth == Stage::Depth::kBottom || (stage.gain == 0 && !recording_.ground);
  }

  const SmoothBody& body_;
  const ChosenBody& chosen_;
  const std::vector<Episode>& episodes_;
  const TrainOptions& options_;
  Course course_;
  Recording recording_;
};

MotionProblem::Options SmoothFit::Follow(const Stage& stage) const {
  MotionProblem::Options follow = FollowOptions(recording_, chosen_.body, options_);
  follow.threads = 1;  // the differences run in parallel
  follow.rollout.observer_gain = stage.gain;
  if (stage.depth == Stage::Depth::kRough) follow.rollout.single_precision = true;
  if (IsExact(stage)) follow.rollout.single_precision = false;
  follow.most_rate = body_.most_rate();
  return follow;
}

// The step of exact differences. Near the bottom, the error of a long one is as large as the slope
// itself, and the fit would stop above. Contacts make residuals jump, and want a long one still.
double ExactDifference(const Recording& recording) {
  constexpr double kExact = 1e-5;
  return recording.ground ? FactorDifference(recording) : kExact;
}

// A fit has arrived where a step gains less than one in chi^2, which is about the number of
// residuals where these are noise. Of many residuals a smaller part of them is enough.
double ToleranceFor(const Stage& stage, int residuals) {
  constexpr double kLeast = 2e-5;
  return stage.depth == Stage::Depth::kRough ? kRoughTolerance
                                             : std::max(kLeast, 1.0 / std::max(1, residuals));
}

// Sub-steps a second.
double HighestRate(const LiftedMotion::Substeps& substeps, const std::vector<Episode>& episodes) {
  double highest = 0;
  for (std::size_t e = 0; e < substeps.counts.size(); ++e) {
    highest = std::max(highest, substeps.counts[e] * episodes[e].recording->fps);
  }
  return highest;
}

SystemMap MapOf(const SmoothBody& body) {
  return SystemMap::OfResiduals([body](const Eigen::VectorXd& x) { return body.Apply(x); });
}

StepReport SmoothFit::Step(SmoothState* state) const {
  const Stage& stage = course_.at(static_cast<std::size_t>(state->stage));
  const bool rough = stage.depth == Stage::Depth::kRough;
  const bool bottom = stage.depth == Stage::Depth::kBottom;
  MotionProblem problem(MapOf(body_), episodes_, Follow(stage));
  // A sub-step more or less would look like a slope. At the bottom it would stop the fit, too.
  MotionProblem::Options kept = Follow(stage);
  kept.keep_substeps = true;
  kept.least_rate = state->least_rate;
  MotionProblem nearby(MapOf(body_), episodes_, kept);
  LevenbergMarquardtState fit{state->x, state->damping};
  const bool damped = state->damping > kSmoothDamping;
  fit.converged = true;
  if (nearby.FixSubsteps(fit.x)) {
    LevenbergMarquardtOptions levenberg = chosen_.body.kind->FactorOptions(recording_);
    if (IsExact(stage)) levenberg.difference = ExactDifference(recording_);
    levenberg.precisions = body_.Precision(fit.x);
    levenberg.tolerance = ToleranceFor(stage, problem.residual_count());
    levenberg.updates = kUpdates;
    levenberg.threads = options_.threads;
    if (bottom) state->least_rate = HighestRate(nearby.substeps(), episodes_);
    fit = LevenbergMarquardtStep(ResidualsOf(bottom ? nearby : problem), fit, levenberg,
                                 ResidualsOf(nearby));
  }
  state->x = fit.x;
  state->damping = fit.damping;
  ++state->iteration;
  const int most_steps = rough ? kMostRoughSteps : kMostSteps;
  const double of_stage = static_cast<double>(state->iteration) / most_steps;
  StepReport report{
      false, (state->stage + of_stage) / static_cast<double>(course_.size()),
      fmt::format("smooth body, {}: {:.3f} mm",
                  stage.gain > 0 ? fmt::format("observer's gain {}", stage.gain) : "free motion",
                  PointMillimetres(fit.mean_square))};
  // a short step gains little wherever it is made: one that is not so damped has to confirm it
  if (fit.converged) state->damping = kSmoothDamping;
  if (state->iteration < most_steps && (!fit.converged || damped)) return report;
  state->iteration = 0;
  state->damping = kSmoothDamping;
  report.done = ++state->stage == static_cast<int>(course_.size());
  return report;
}

std::optional<LinearisedFit> SmoothFit::LineariseAt(const Eigen::VectorXd& x) const {
  MotionProblem::Options kept = Follow({0, Stage::Depth::kBottom});
  kept.keep_substeps = true;
  MotionProblem nearby(MapOf(body_), episodes_, kept);
  if (!nearby.FixSubsteps(x)) return {};
  std::optional<Eigen::VectorXd> residuals = nearby.Residuals(x);
  if (!residuals) return {};
  const Differences differences{0, body_.size(), ExactDifference(recording_), options_.threads};
  Eigen::MatrixXd slope = DifferenceColumns(ResidualsOf(nearby), x, *residuals, differences);
  return LinearisedFit{std::move(*residuals), std::move(slope)};
}

SmoothlyFitted Fit(const SmoothlyFitted& start, const Course& course, const ChosenBody& chosen,
                   const std::vector<Episode>& episodes, const TrainOptions& options,
                   const Work& work) {
  const SmoothFit fit(start.body, chosen, episodes, options, course);
  return {start.body,
          work.Follow(SmoothState{start.x}, [&](SmoothState* one) { return fit.Step(one); }).x};
}

}  // namespace

SmoothlyFitted SoftSmoothBody(const ChosenBody& chosen, const std::vector<Episode>& episodes,
                              const SmoothBody::Options& body, double lossier) {
  const Recording recording = OnlyFitFrames(episodes.at(0));
  SpringMassSystem start = StartOf(chosen, recording);
  start.dashpot *= lossier;
  const SmoothBody smooth(start, recording, *chosen.body.kind, body);
  return {smooth, SoftBeyond(chosen.body.soft_beyond, smooth)};
}

SmoothlyFitted FitRoughly(const SmoothlyFitted& start, const std::vector<double>& gains,
                          const ChosenBody& chosen, const std::vector<Episode>& episodes,
                          const TrainOptions& options, const Work& work) {
  Course course;
  for (double gain : gains) course.push_back({gain, Stage::Depth::kRough});
  return Fit(start, course, chosen, episodes, options, work);
}

SmoothlyFitted FitToTheEnd(const SmoothlyFitted& start, const ChosenBody& chosen,
                           const std::vector<Episode>& episodes, const TrainOptions& options,
                           const Work& work) {
  Course course = {{0, Stage::Depth::kEnd}};
  if (!episodes.at(0).recording->ground) course.push_back({0, Stage::Depth::kBottom});
  return Fit(start, course, chosen, episodes, options, work);
}

std::optional<LinearisedFit> LineariseFit(const SmoothlyFitted& fit, const ChosenBody& chosen,
                                          const std::vector<Episode>& episodes,
                                          const TrainOptions& options) {
  return SmoothFit(fit.body, chosen, episodes, options).LineariseAt(fit.x);
}

}  // namespace physpring
