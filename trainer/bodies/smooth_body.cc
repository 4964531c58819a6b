// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/smooth_body.h"

#include "trainer/bodies/factors.h"
#include "trainer/bodies/spring_modes.h"
#include "trainer/solvers/levenberg_marquardt.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr int kModes = 8;
// Of irregular meshes. Springs that are superfluous begin at some length: within one class they
// could not be told from true ones.
constexpr int kEqualClasses = 30;
constexpr double kClassJump = 1.01;  // true and superfluous springs may differ in length by 1.5 %
constexpr double kMode = 0.5;        // the prior's standard deviation

ParameterOptions SmoothOptions(const SpringMassSystem& start, const Recording& recording,
                               const BodyKind& kind) {
  ParameterOptions options = CommonOptions(start, recording, kind);
  options.loss_times = true;
  options.class_dashpots = false;
  options.class_jump = kClassJump;
  options.equal_classes = kEqualClasses;
  options.modes = SpringModes(start, kModes);
  return options;
}

}  // namespace

SmoothBody::SmoothBody(const SpringMassSystem& start, const Recording& recording,
                       const BodyKind& kind, double most_rate)
    : factors_(start, SmoothOptions(start, recording, kind)), most_rate_(most_rate) {}

Eigen::VectorXd SmoothBody::Precision() const {
  Eigen::VectorXd precision = Eigen::VectorXd::Constant(size(), kLevenbergMarquardtPrecision);
  for (int i = 0; i < size(); ++i) {
    if (factors_.kind(i) == Parameters::Kind::kMode) precision[i] = 1 / (kMode * kMode);
  }
  return precision;
}

SpringMassSystem SmoothBody::Apply(const Eigen::VectorXd& x) const {
  SpringMassSystem system = factors_.Apply(x);
  LimitDashpots(1 / most_rate_ / kStepSafety, &system);
  return system;
}

}  // namespace physpring
