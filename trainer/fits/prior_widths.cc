// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/prior_widths.h"

#include <Eigen/Cholesky>
#include <array>

namespace physpring {
namespace {

// The widths that are tried: those of smooth_body.h, and narrower ones.
constexpr std::array<double, 6> kFieldWidths = {0.5, 0.25, 0.12, 0.06, 0.03, 0.015};
constexpr std::array<double, 7> kClassWidths = {2, 1, 0.5, 0.25, 0.12, 0.06, 0.03};
constexpr std::array<double, 6> kHandWidths = {kInfinity, 1, 0.3, 0.1, 0.03, 0.01};

double LogDeterminant(const Eigen::LLT<Eigen::MatrixXd>& factor) {
  return 2 * factor.matrixLLT().diagonal().array().log().sum();
}

// The fit as a quadratic function of the numbers' change d: |r|^2 / variance is
// d^T normal d + 2 d^T gradient, up to a constant.
struct Quadratic {
  Eigen::MatrixXd normal;
  Eigen::VectorXd gradient;

  // Twice the logarithm of the evidence of a body with these widths, up to a constant.
  double EvidenceOf(const SmoothBody& body, const Eigen::VectorXd& x) const {
    const Eigen::MatrixXd precision = body.Precision(x);
    const Eigen::LLT<Eigen::MatrixXd> posterior(normal + precision), prior(precision);
    const Eigen::VectorXd change = -posterior.solve(gradient + precision * x);
    const Eigen::VectorXd there = x + change;
    const double misfit = change.dot(normal * change) + 2 * change.dot(gradient);
    return -misfit - there.dot(precision * there) + LogDeterminant(prior) -
           LogDeterminant(posterior);
  }
};

}  // namespace

SmoothBody::Widths MostProbableWidths(const SmoothlyFitted& fit, const LinearisedFit& linearised) {
  const auto& [residuals, slope] = linearised;
  const double variance = residuals.squaredNorm() / static_cast<double>(residuals.size());
  const Quadratic quadratic{slope.transpose() * slope / variance,
                            slope.transpose() * residuals / variance};
  SmoothBody body = fit.body;
  SmoothBody::Widths best = body.options().widths;
  double most = quadratic.EvidenceOf(body, fit.x);
  for (double field : kFieldWidths) {
    for (double classes : kClassWidths) {
      for (double hands : kHandWidths) {
        body.SetWidths({field, classes, hands});
        const double evidence = quadratic.EvidenceOf(body, fit.x);
        if (evidence <= most) continue;
        most = evidence;
        best = {field, classes, hands};
      }
    }
  }
  return best;
}

}  // namespace physpring
