// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/effect_certainty.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "trainer/solvers/levenberg_marquardt.h"

namespace physpring {
namespace {

// The last `count` of a system's effect values, one effect after the other.
Eigen::VectorXd LastValuesOf(const SpringMassSystem& system, int count) {
  Eigen::VectorXd values(0);
  for (const EffectValues& effect : system.effects) {
    const Eigen::Index first = values.size();
    values.conservativeResize(first + effect.values.size());
    values.tail(effect.values.size()) = effect.values;
  }
  return values.tail(count);
}

// How the gradients of stretches of rows, which go on in time, scatter, scaled to the sum over all
// stretches.
Eigen::MatrixXd GradientScatter(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& r) {
  constexpr Eigen::Index kStretches = 20;
  Eigen::MatrixXd gradients(jacobian.cols(), kStretches);
  for (Eigen::Index i = 0; i < kStretches; ++i) {
    const Eigen::Index first = i * r.size() / kStretches, last = (i + 1) * r.size() / kStretches;
    gradients.col(i) =
        jacobian.middleRows(first, last - first).transpose() * r.segment(first, last - first);
  }
  gradients.colwise() -= gradients.rowwise().mean().eval();
  return gradients * gradients.transpose() * (static_cast<double>(kStretches) / (kStretches - 1));
}

}  // namespace

std::vector<ValueCertainty> CertaintyFrom(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& r,
                                          const Eigen::MatrixXd& precision, int first) {
  const Eigen::Index size = jacobian.cols();
  const double variance = std::max(1e-300, r.squaredNorm() / static_cast<double>(r.size()));
  const Eigen::MatrixXd normal = jacobian.transpose() * jacobian / variance + precision;
  const Eigen::MatrixXd covariance = normal.ldlt().solve(Eigen::MatrixXd::Identity(size, size));
  const Eigen::MatrixXd scatter = GradientScatter(jacobian, r) / (variance * variance) + precision;
  const Eigen::MatrixXd robust = covariance * scatter * covariance;
  std::vector<ValueCertainty> certainty;
  for (Eigen::Index i = first; i < size; ++i) {
    certainty.push_back({std::sqrt(std::max({0.0, covariance(i, i), robust(i, i)})),
                         std::clamp(1 - 1 / (normal(i, i) * covariance(i, i)), 0.0, 1.0),
                         std::clamp(precision(i, i) * covariance(i, i), 0.0, 1.0)});
  }
  return certainty;
}

std::vector<ValueCertainty> CertaintyOf(const Fitting& fitting, const Descent& fit) {
  EffectProblem problem = fitting.Problem(fit.hypothesis, 0, Fitting::Care::kExact);
  if (!problem.FixSubsteps(fit.x)) return {};
  const auto r = problem.Residuals(fit.x);
  if (!r || r->size() == 0) return {};
  const auto size = static_cast<int>(fit.x.size());
  const Eigen::MatrixXd jacobian = DifferenceColumns(
      ResidualsOf(problem), fit.x, *r, {0, size, fitting.difference(), fitting.threads()});
  const int count = problem.model().effect_size(), own = size - count;
  const Eigen::VectorXd values = LastValuesOf(problem.model().Apply(fit.x), count);
  std::vector<ValueCertainty> certainty =
      CertaintyFrom(jacobian, *r, problem.model().Precision(fit.x), own);
  for (int i = 0; i < count; ++i) {
    // how far the value moves with its entry of x
    Eigen::VectorXd moved = fit.x;
    moved[own + i] += fitting.difference();
    const double slope =
        std::abs(LastValuesOf(problem.model().Apply(moved), count)[i] - values[i]) /
        fitting.difference();
    certainty[static_cast<std::size_t>(i)].error *= slope;
  }
  return certainty;
}

}  // namespace physpring
