// SPDX-License-Identifier: Apache-2.0
#include "trainer/chosen_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace physpring {
namespace {

constexpr double kRobust = 2;  // medians of the residuals, up to which their squares count

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

Parameters ChosenModel::Factors(const Recording& recording) const {
  return CommonFactors(StartSystem(recording, candidate, start_substeps), recording,
                       candidate.free_effects);
}

SpringMassSystem ChosenModel::System(const Recording& recording) const {
  return Factors(recording).Apply(factors);
}

LevenbergMarquardtState StepFactors(const ChosenModel& model, const std::vector<Episode>& episodes,
                                    const TrainOptions& options, double gain, double damping) {
  const Recording& recording = *episodes.at(0).recording;
  MotionProblem::Options follow = FollowOptions(recording, model.candidate, options);
  follow.threads = 1;                                          // the differences run in parallel
  if (!model.candidate.is_chain()) follow.most_substeps /= 2;  // single springs want room
  follow.rollout.observer_gain = gain;
  const Parameters factors = model.Factors(recording);
  MotionProblem problem(factors, episodes, follow);
  LevenbergMarquardtOptions levenberg = FactorOptions(recording, model.candidate);
  levenberg.threads = options.threads;
  LevenbergMarquardtState state;
  state.x = model.factors;
  state.damping = damping;
  // a chain that is far off for a while would outweigh all others
  double limit = std::numeric_limits<double>::infinity();
  if (model.candidate.is_chain()) {
    if (const auto r = problem.Residuals(state.x)) limit = kRobust * MedianSize(*r);
  }
  const auto residuals = [&](const Eigen::VectorXd& x) {
    auto r = problem.Residuals(x);
    if (r && std::isfinite(limit)) r = Robust(*r, limit);
    return r;
  };
  return LevenbergMarquardtStep(residuals, state, levenberg);
}

}  // namespace physpring
