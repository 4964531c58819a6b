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

// How a body follows the episodes: with each of these gains of the observer, one after the other.
struct Course {
  std::vector<double> gains;
  bool rough;  // in floats, and not to the end
};

struct SmoothState {
  Eigen::VectorXd x;
  int gain = 0;                     // an index of Course::gains
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
            const TrainOptions& options, const Course& course)
      : body_(body),
        chosen_(chosen),
        episodes_(episodes),
        options_(options),
        course_(course),
        recording_(OnlyFitFrames(episodes.at(0))) {}

  StepReport Step(SmoothState* state) const;

 private:
  MotionProblem::Options Follow(double gain) const;
  double ToleranceFor(int residuals) const;

  const SmoothBody& body_;
  const ChosenBody& chosen_;
  const std::vector<Episode>& episodes_;
  const TrainOptions& options_;
  const Course& course_;
  Recording recording_;
};

MotionProblem::Options SmoothFit::Follow(double gain) const {
  MotionProblem::Options follow = FollowOptions(recording_, chosen_.body, options_);
  follow.threads = 1;  // the differences run in parallel
  follow.rollout.observer_gain = gain;
  follow.rollout.single_precision |= course_.rough;
  follow.most_rate = body_.most_rate();
  return follow;
}

// A fit has arrived where a step gains less than one in chi^2, which is about the number of
// residuals where these are noise. Of many residuals a smaller part of them is enough.
double SmoothFit::ToleranceFor(int residuals) const {
  constexpr double kLeast = 2e-5;
  return course_.rough ? kRoughTolerance : std::max(kLeast, 1.0 / std::max(1, residuals));
}

SystemMap MapOf(const SmoothBody& body) {
  return SystemMap::OfResiduals([body](const Eigen::VectorXd& x) { return body.Apply(x); });
}

StepReport SmoothFit::Step(SmoothState* state) const {
  const double gain = course_.gains.at(static_cast<std::size_t>(state->gain));
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
    levenberg.tolerance = ToleranceFor(problem.residual_count());
    levenberg.updates = kUpdates;
    levenberg.threads = options_.threads;
    fit = LevenbergMarquardtStep(ResidualsOf(problem), fit, levenberg, ResidualsOf(nearby));
  }
  state->x = fit.x;
  state->damping = fit.damping;
  ++state->iteration;
  const int most_steps = course_.rough ? kMostRoughSteps : kMostSteps;
  const double of_gain = static_cast<double>(state->iteration) / most_steps;
  StepReport report{false, (state->gain + of_gain) / static_cast<double>(course_.gains.size()),
                    fmt::format("smooth body, {}: {:.3f} mm",
                                gain > 0 ? fmt::format("observer's gain {}", gain) : "free motion",
                                PointMillimetres(fit.mean_square))};
  // a short step gains little wherever it is made: one that is not so damped has to confirm it
  if (fit.converged) state->damping = kSmoothDamping;
  if (state->iteration < most_steps && (!fit.converged || damped)) return report;
  state->iteration = 0;
  state->damping = kSmoothDamping;
  report.done = ++state->gain == static_cast<int>(course_.gains.size());
  return report;
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
  return {smooth, Eigen::VectorXd::Zero(smooth.size())};
}

SmoothlyFitted FitRoughly(const SmoothlyFitted& start, const std::vector<double>& gains,
                          const ChosenBody& chosen, const std::vector<Episode>& episodes,
                          const TrainOptions& options, const Work& work) {
  return Fit(start, {gains, true}, chosen, episodes, options, work);
}

SmoothlyFitted FitToTheEnd(const SmoothlyFitted& start, const ChosenBody& chosen,
                           const std::vector<Episode>& episodes, const TrainOptions& options,
                           const Work& work) {
  return Fit(start, {{0}, false}, chosen, episodes, options, work);
}

}  // namespace physpring
