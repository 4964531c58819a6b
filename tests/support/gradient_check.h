// SPDX-License-Identifier: Apache-2.0
// Compares derivatives of a loss with central differences, extrapolated once (Richardson):
//   D(s) = (loss(x + s) - loss(x - s)) / (2 s),   numeric = (4 D(s / 2) - D(s)) / 3
// The difference of two such estimates, from s and from s / 2, is the doubt about the numeric one:
// near a switch of the loss (a contact that begins) the two disagree, and the check fails rather
// than compare with a number that means nothing.
#ifndef PHYSPRING_TESTS_SUPPORT_GRADIENT_CHECK_H_
#define PHYSPRING_TESTS_SUPPORT_GRADIENT_CHECK_H_

#include <functional>
#include <string>
#include <vector>

namespace physpring {

// A loss is summed in long double: rounding it to double would be most of the error of a
// difference.
using LossFunction = std::function<long double()>;

// A variable of the loss, with the derivative that is to be checked.
struct CheckedVariable {
  std::string name;
  double* variable;   // is moved and put back
  double step;        // s: small against the scale on which the loss bends
  double derivative;  // d loss / d variable, as the code under test has it
};

struct GradientReport {
  bool passed = true;
  double worst_error = 0;  // relative, over all variables
  double worst_doubt = 0;  // relative
  std::string log;         // a line a variable: name, derivative, numeric, error, doubt
};

// Passes if for every variable both the error and the doubt are at most `tolerance`, relative to
// the larger of derivative and numeric, or to `floor` times the largest derivative of all variables
// (a derivative much smaller than the others drowns in the rounding of the loss).
GradientReport CheckGradient(const LossFunction& loss,
                             const std::vector<CheckedVariable>& variables, double tolerance = 1e-6,
                             double floor = 1e-3);

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_GRADIENT_CHECK_H_
