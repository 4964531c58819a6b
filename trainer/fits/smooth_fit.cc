// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/smooth_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace physpring {
namespace {

// A stage of the fit: the observer's gain, the first part of each motion that is followed, and the
// most steps. All stages but the last one only show the way.
struct Stage {
  double gain, part;
  int most_steps;
};
constexpr std::array<Stage, 5> kStages = {
    {{0.5, 0.4, 40}, {0.2, 0.4, 40}, {0.1, 0.4, 40}, {0, 0.4, 40}, {0, 1, 80}}};
constexpr int kLastStage = static_cast<int>(kStages.size()) - 1;
// A stage that shows the way ends where a step gains less than this part of the objective.
constexpr double kGuidedTolerance = 2e-3;
constexpr int kUpdates = 4;              // of the Jacobian in a step
constexpr double kSmoothDamping = 1e-2;  // the damping with which each stage begins

struct SmoothState {
  Eigen::VectorXd x;
  int stage = 0;                    // an index of kStages
  int iteration = 0;                // steps made in this stage
  double damping = kSmoothDamping;  // of the next step

  template <class Visitor>
  void Visit(Visitor&& visit) {
    visit(x, stage, iteration, damping);
  }
};

// The chosen start, with one loss time for all springs and the contact as chosen.
SpringMassSystem StartOf(const ChosenBody& chosen, const Recording& recording) {
  SpringMassSystem start = StartSystem(recording, chosen.body, chosen.start_substeps);
  start.dashpot = start.stiffness * (start.dashpot.sum() / start.stiffness.sum());
  start.contact = chosen.System(recording).contact;
  return start;
}

// What is fitted, and to what.
class SmoothFit {
 public:
  SmoothFit(const SmoothBody& body, const ChosenBody& chosen, const std::vector<Episode>& episodes,
            const TrainOptions& options)
      : body_(body),
        chosen_(chosen),
        episodes_(episodes),
        options_(options),
        recording_(OnlyFitFrames(episodes.at(0))) {}

  StepReport Step(SmoothState* state) const;

 private:
  MotionProblem::Options Follow(int stage) const;
  std::vector<Episode> FirstPart(double part) const;

  const SmoothBody& body_;
  const ChosenBody& chosen_;
  const std::vector<Episode>& episodes_;
  const TrainOptions& options_;
  Recording recording_;
};

MotionProblem::Options SmoothFit::Follow(int stage) const {
  MotionProblem::Options follow = FollowOptions(recording_, chosen_.body, options_);
  follow.threads = 1;  // the differences run in parallel
  follow.rollout.observer_gain = kStages[static_cast<std::size_t>(stage)].gain;
  follow.rollout.single_precision |= stage < kLastStage;
  follow.most_rate = body_.most_rate();
  return follow;
}

std::vector<Episode> SmoothFit::FirstPart(double part) const {
  std::vector<Episode> first = episodes_;
  for (Episode& one : first) {
    one.frames = std::max(2, 1 + static_cast<int>(std::ceil(part * (one.frames - 1))));
  }
  return first;
}

SystemMap MapOf(const SmoothBody& body) {
  return SystemMap::OfResiduals([body](const Eigen::VectorXd& x) { return body.Apply(x); });
}

// The last stage has arrived where a step gains less than one in chi^2, which is about the number
// of residuals where these are noise. Of many residuals a smaller part of them is enough.
double ToleranceOf(int stage, int residuals) {
  constexpr double kLeast = 2e-5;
  return stage < kLastStage ? kGuidedTolerance : std::max(kLeast, 1.0 / std::max(1, residuals));
}

StepReport SmoothFit::Step(SmoothState* state) const {
  const auto& [gain, part, most_steps] = kStages.at(static_cast<std::size_t>(state->stage));
  const std::vector<Episode> episodes = FirstPart(part);
  MotionProblem problem(MapOf(body_), episodes, Follow(state->stage));
  // a sub-step more or less would look like a slope
  MotionProblem::Options kept = Follow(state->stage);
  kept.keep_substeps = true;
  MotionProblem nearby(MapOf(body_), episodes, kept);
  LevenbergMarquardtState fit{state->x, state->damping};
  const bool damped = state->damping > kSmoothDamping;
  fit.converged = true;
  if (nearby.FixSubsteps(fit.x)) {
    LevenbergMarquardtOptions levenberg = chosen_.body.kind->FactorOptions(recording_);
    levenberg.precisions = body_.Precision(fit.x);
    levenberg.tolerance = ToleranceOf(state->stage, problem.residual_count());
    levenberg.updates = kUpdates;
    levenberg.threads = options_.threads;
    fit = LevenbergMarquardtStep(ResidualsOf(problem), fit, levenberg, ResidualsOf(nearby));
  }
  state->x = fit.x;
  state->damping = fit.damping;
  ++state->iteration;
  const double of_stage = static_cast<double>(state->iteration) / most_steps;
  StepReport report{
      false, (state->stage + of_stage) / (kLastStage + 1),
      fmt::format("smooth body, {}{}: {:.3f} mm",
                  gain > 0 ? fmt::format("observer's gain {}", gain) : "free motion",
                  part < 1 ? " of the first frames" : "", PointMillimetres(fit.mean_square))};
  // a short step gains little wherever it is made: one that is not so damped has to confirm it
  if (fit.converged) state->damping = kSmoothDamping;
  if (state->iteration < most_steps && (!fit.converged || damped)) return report;
  state->iteration = 0;
  state->damping = kSmoothDamping;
  report.done = ++state->stage > kLastStage;
  return report;
}

SmoothlyFitted Fit(const SmoothlyFitted& start, int first_stage, const ChosenBody& chosen,
                   const std::vector<Episode>& episodes, const TrainOptions& options,
                   const Work& work) {
  const SmoothFit fit(start.body, chosen, episodes, options);
  return {start.body, work.Follow(SmoothState{start.x, first_stage},
                                  [&](SmoothState* one) { return fit.Step(one); })
                          .x};
}

}  // namespace

SmoothlyFitted FitSmoothBody(const ChosenBody& chosen, const std::vector<Episode>& episodes,
                             const TrainOptions& options, const SmoothBody::Options& body,
                             const Work& work) {
  const Recording recording = OnlyFitFrames(episodes.at(0));
  const SmoothBody smooth(StartOf(chosen, recording), recording, *chosen.body.kind, body);
  return Fit({smooth, Eigen::VectorXd::Zero(smooth.size())}, 0, chosen, episodes, options, work);
}

SmoothlyFitted FitOn(const SmoothlyFitted& start, const ChosenBody& chosen,
                     const std::vector<Episode>& episodes, const TrainOptions& options,
                     const Work& work) {
  return Fit(start, kLastStage, chosen, episodes, options, work);
}

}  // namespace physpring
