// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/chosen_body.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace physpring {
namespace {

constexpr double kRobust = 2;  // residuals up to so many medians count by their squares

double MedianSize(const Eigen::VectorXd& r) {
  std::vector<double> size(static_cast<std::size_t>(r.size()));
  std::transform(r.begin(), r.end(), size.begin(), [](double value) { return std::abs(value); });
  const auto middle = size.begin() + static_cast<std::ptrdiff_t>(size.size() / 2);
  std::nth_element(size.begin(), middle, size.end());
  return *middle;
}

// Residuals whose squares are Huber's measure of r: r^2, and w (2 |r| - w) beyond w.
Eigen::VectorXd Robust(const Eigen::VectorXd& r, double w) {
  return r.unaryExpr([w](double value) {
    const double size = std::abs(value);
    return size <= w ? value : std::copysign(std::sqrt(w * (2 * size - w)), value);
  });
}

}  // namespace

Parameters ChosenBody::ParametersOf(const Recording& recording) const {
  return CommonFactors(StartSystem(recording, body, start_substeps), recording, *body.kind);
}

SpringMassSystem ChosenBody::System(const Recording& recording) const {
  return ParametersOf(recording).Apply(factors);
}

ChosenBody ChosenBody::WithOtherVelocity() const {
  ChosenBody other = *this;
  other.body.controller_velocity = !body.controller_velocity;
  return other;
}

ChosenBody ChosenBody::WithOtherCone() const {
  ChosenBody other = *this;
  other.body.cone =
      body.cone == FrictionCone::kElliptic ? FrictionCone::kPyramidal : FrictionCone::kElliptic;
  return other;
}

ChosenBody ChosenBody::WithSoftSprings(const Recording& recording) const {
  ChosenBody more = *this;
  more.body = physpring::WithSoftSprings(body, recording);
  if (more.body.radius == body.radius) return more;
  const Parameters common = more.ParametersOf(recording);
  more.factors = Eigen::VectorXd::Zero(common.size());
  more.factors.head(common.first_class()) = factors.head(common.first_class());
  return more;
}

LevenbergMarquardtState StepFactors(const ChosenBody& model, const std::vector<Episode>& episodes,
                                    const TrainOptions& options, double gain, double damping) {
  const Recording recording = OnlyFitFrames(episodes.at(0));
  MotionProblem::Options follow = FollowOptions(recording, model.body, options);
  follow.threads = 1;  // the differences run in parallel
  if (model.body.kind->has_single_springs()) follow.most_substeps /= 2;  // single springs want room
  follow.rollout.observer_gain = gain;
  const Parameters factors = model.ParametersOf(recording);
  MotionProblem problem(factors, episodes, follow);
  LevenbergMarquardtOptions levenberg = model.body.kind->FactorOptions(recording);
  levenberg.threads = options.threads;
  LevenbergMarquardtState state;
  state.x = model.factors;
  state.damping = damping;
  // a chain that is far off for a while would outweigh all others
  double limit = std::numeric_limits<double>::infinity();
  if (!model.body.kind->has_single_springs()) {
    if (const auto r = problem.Residuals(state.x)) limit = kRobust * MedianSize(*r);
  }
  const auto residuals = [&](const std::vector<Eigen::VectorXd>& xs) {
    auto all = problem.Residuals(xs);
    for (auto& r : all) {
      if (r && std::isfinite(limit)) r = Robust(*r, limit);
    }
    return all;
  };
  return LevenbergMarquardtStep(residuals, state, levenberg);
}

}  // namespace physpring
