// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/smooth_fit.h"

#include <fmt/format.h>

#include "trainer/motion/observer.h"

namespace physpring {
namespace {

// The most steps with each gain, and when they end: a gain above 0 only shows the way.
constexpr int kGuidedSteps = 40, kFreeSteps = 80;
constexpr double kFollowedTolerance = 2e-3, kFreeTolerance = 1e-5;
constexpr int kUpdates = 4;              // of the Jacobian in a step
constexpr double kSmoothDamping = 1e-2;  // the damping with which each gain begins

struct SmoothState {
  Eigen::VectorXd x;
  int gain = 0;                     // an index of kObserverGains
  int iteration = 0;                // steps made with this gain
  double damping = kSmoothDamping;  // of the next step

  template <class Visitor>
  void Visit(Visitor&& visit) {
    visit(x, gain, iteration, damping);
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
  MotionProblem::Options Follow(double gain) const;

  const SmoothBody& body_;
  const ChosenBody& chosen_;
  const std::vector<Episode>& episodes_;
  const TrainOptions& options_;
  Recording recording_;
};

MotionProblem::Options SmoothFit::Follow(double gain) const {
  MotionProblem::Options follow = FollowOptions(recording_, chosen_.body, options_);
  follow.threads = 1;  // the differences run in parallel
  follow.rollout.observer_gain = gain;
  follow.most_rate = body_.most_rate();
  return follow;
}

SystemMap MapOf(const SmoothBody& body) {
  return SystemMap::OfResiduals([body](const Eigen::VectorXd& x) { return body.Apply(x); });
}

StepReport SmoothFit::Step(SmoothState* state) const {
  const double gain = kObserverGains[state->gain];
  const int most_steps = state->gain == kLastGain ? kFreeSteps : kGuidedSteps;
  MotionProblem problem(MapOf(body_), episodes_, Follow(gain));
  // a sub-step more or less would look like a slope
  MotionProblem::Options kept = Follow(gain);
  kept.keep_substeps = true;
  MotionProblem nearby(MapOf(body_), episodes_, kept);
  LevenbergMarquardtState fit{state->x, state->damping};
  const bool damped = state->damping > kSmoothDamping;
  fit.converged = true;
  if (nearby.FixSubsteps(fit.x)) {
    LevenbergMarquardtOptions levenberg = chosen_.body.kind->FactorOptions(recording_);
    levenberg.precisions = body_.Precision(fit.x);
    levenberg.tolerance = state->gain == kLastGain ? kFreeTolerance : kFollowedTolerance;
    levenberg.updates = kUpdates;
    levenberg.threads = options_.threads;
    fit = LevenbergMarquardtStep(ResidualsOf(problem), fit, levenberg, ResidualsOf(nearby));
  }
  state->x = fit.x;
  state->damping = fit.damping;
  ++state->iteration;
  const double of_gain = static_cast<double>(state->iteration) / most_steps;
  StepReport report{false, (state->gain + of_gain) / (kLastGain + 1),
                    fmt::format("smooth body, {}: {:.3f} mm",
                                gain > 0 ? fmt::format("observer's gain {}", gain) : "free motion",
                                PointMillimetres(fit.mean_square))};
  // a short step gains little wherever it is made: one that is not so damped has to confirm it
  if (fit.converged) state->damping = kSmoothDamping;
  if (state->iteration < most_steps && (!fit.converged || damped)) return report;
  state->iteration = 0;
  state->damping = kSmoothDamping;
  report.done = ++state->gain > kLastGain;
  return report;
}

SmoothlyFitted Fit(const SmoothlyFitted& start, int first_gain, const ChosenBody& chosen,
                   const std::vector<Episode>& episodes, const TrainOptions& options,
                   const Work& work) {
  const SmoothFit fit(start.body, chosen, episodes, options);
  return {start.body, work.Follow(SmoothState{start.x, first_gain},
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
  return Fit(start, kLastGain, chosen, episodes, options, work);
}

}  // namespace physpring
