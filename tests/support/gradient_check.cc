// SPDX-License-Identifier: Apache-2.0
#include "tests/support/gradient_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace physpring {
namespace {

struct Estimate {
  double value;
  double doubt;
};

Estimate CentralDifference(const LossFunction& loss, double* variable, double step) {
  const double x = *variable;
  const auto difference = [&](double s) {
    *variable = x + s;
    const double right = *variable;
    const long double above = loss();
    *variable = x - s;
    const double width = right - *variable;  // 2 s as rounded
    const long double below = loss();
    *variable = x;
    return static_cast<double>(above - below) / width;
  };
  const double coarse = difference(step);
  const double middle = difference(step / 2);
  const double fine = difference(step / 4);
  const double first = (4 * middle - coarse) / 3;
  const double second = (4 * fine - middle) / 3;
  return {second, std::abs(second - first)};
}

}  // namespace

GradientReport CheckGradient(const LossFunction& loss,
                             const std::vector<CheckedVariable>& variables, double tolerance,
                             double floor) {
  double largest = 0;
  for (const CheckedVariable& v : variables) largest = std::max(largest, std::abs(v.derivative));
  GradientReport report;
  for (const CheckedVariable& v : variables) {
    const Estimate numeric = CentralDifference(loss, v.variable, v.step);
    const double size =
        std::max({std::abs(v.derivative), std::abs(numeric.value), floor * largest});
    const auto relative = [&](double value) { return value == 0 ? 0 : std::abs(value) / size; };
    const double error = relative(v.derivative - numeric.value);
    const double doubt = relative(numeric.doubt);
    const bool passed = error <= tolerance && doubt <= tolerance;  // false for NaN, too
    report.passed = report.passed && passed;
    report.worst_error = std::max(report.worst_error, error);
    report.worst_doubt = std::max(report.worst_doubt, doubt);
    report.log +=
        fmt::format("{} {}: derivative {:.12g}, numeric {:.12g}, error {:.1e}, doubt {:.1e}\n",
                    passed ? " ok " : "FAIL", v.name, v.derivative, numeric.value, error, doubt);
  }
  return report;
}

}  // namespace physpring
