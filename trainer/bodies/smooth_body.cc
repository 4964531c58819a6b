// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/smooth_body.h"

#include <algorithm>
#include <cmath>

#include "trainer/bodies/factors.h"
#include "trainer/bodies/spring_modes.h"
#include "trainer/solvers/levenberg_marquardt.h"
#include "twin/dashpot_stages.h"

namespace physpring {
namespace {

constexpr int kModes = 14, kFewModes = 6;
// Of irregular meshes. Springs that are superfluous begin at some length: within one class they
// could not be told from true ones.
constexpr int kEqualClasses = 30;
constexpr double kClassJump = 1.01;  // true and superfluous springs may differ in length by 1.5 %
// The prior's standard deviations: of the difference between a class and the one before it whose
// springs are much like its own, and of an even slope of the field.
constexpr double kNeighbouringClasses = 0.5, kSlope = 0.5;

// Few modes are all smooth, and held alike. Even slopes are not rough at all.
FieldModes ModesOf(const SpringMassSystem& start, SmoothBody::Numbers numbers) {
  if (numbers == SmoothBody::Numbers::kFew) {
    FieldModes few = SpringModes(start, kFewModes);
    few.roughness.setOnes();
    return few;
  }
  const Eigen::MatrixXd slopes = EvenSlopes(start);
  const FieldModes modes = SpringModes(start, kModes);
  FieldModes all{Eigen::MatrixXd(start.spring_count(), slopes.cols() + modes.fields.cols()),
                 Eigen::VectorXd(slopes.cols() + modes.fields.cols())};
  all.fields << slopes, modes.fields;
  all.roughness << Eigen::VectorXd::Zero(slopes.cols()), modes.roughness;
  return all;
}

ParameterOptions SmoothOptions(const SpringMassSystem& start, const Recording& recording,
                               const BodyKind& kind, const SmoothBody::Options& body,
                               const Eigen::MatrixXd& modes) {
  ParameterOptions options = CommonOptions(start, recording, kind);
  options.loss_times = true;
  options.class_dashpots = body.class_loss_times;
  options.classes = {.jump = kClassJump,
                     .equal = kEqualClasses,
                     .finer = body.finer,
                     .hands_apart = body.hands_apart,
                     .directions = body.directions};
  options.modes = modes;
  return options;
}

// The mean logarithm of loss times, dashpots over stiffnesses, of springs of controllers or of all
// others; NaN where there are none.
double MeanLogLoss(const SpringMassSystem& system, bool hands) {
  double sum = 0, count = 0;
  for (int e = 0; e < system.spring_count(); ++e) {
    if (system.IsControllerSpring(e) != hands) continue;
    sum += std::log(system.dashpot[e] / system.stiffness[e]);
    count += 1;
  }
  return sum / count;
}

// The fastest mode's frequency times the sub-step, at most, as a part of what is stable: all of it
// would leave no room for dashpots.
constexpr double kStiffest = 0.9;

}  // namespace

SmoothBody::SmoothBody(const SpringMassSystem& start, const Recording& recording,
                       const BodyKind& kind, const Options& options)
    : SmoothBody(start, recording, kind, options, ModesOf(start, options.numbers)) {}

SmoothBody::SmoothBody(const SpringMassSystem& start, const Recording& recording,
                       const BodyKind& kind, const Options& options, const FieldModes& modes)
    : factors_(start, SmoothOptions(start, recording, kind, options, modes.fields)),
      roughness_(modes.roughness),
      options_(options) {
  options_.most_rate = std::max(1.0, std::floor(options.most_rate / recording.fps)) * recording.fps;
}

Eigen::MatrixXd SmoothBody::Precision(const Eigen::VectorXd& x) const {
  Eigen::MatrixXd precision =
      kLevenbergMarquardtPrecision * Eigen::MatrixXd::Identity(size(), size());
  for (int m = 0; m < roughness_.size(); ++m) {
    const int i = factors_.first_mode() + m;
    precision(i, i) = roughness_[m] > 0 ? std::pow(roughness_[m] / options_.widths.field, 2)
                                        : std::pow(kSlope, -2);
  }
  const double tie = std::pow(options_.widths.hands, -2);
  for (int i : {0, 2}) {  // stiffness and loss time of the object; after each, that of controllers
    precision.block<2, 2>(i, i) += tie * Eigen::Matrix2d{{1, -1}, {-1, 1}};
  }
  const int first = factors_.first_class(), end = first + factors_.classes().lengths;
  for (int i = first; i < end; ++i) precision(i, i) = std::pow(options_.widths.classes, -2);
  for (int i = end; i < first + factors_.classes().count; ++i) precision(i, i) += tie;
  for (int i = first; i + 1 < end; ++i) {
    if (!factors_.classes().like_the_last[static_cast<std::size_t>(i + 1 - first)]) continue;
    const double alike =
        1 / (kNeighbouringClasses * std::max(kNeighbouringClasses, std::abs(x[i + 1] - x[i])));
    precision(i, i) += alike;
    precision(i + 1, i + 1) += alike;
    precision(i, i + 1) -= alike;
    precision(i + 1, i) -= alike;
  }
  return precision;
}

SpringMassSystem SmoothBody::Apply(const Eigen::VectorXd& x) const {
  SpringMassSystem system = factors_.Apply(x);
  if (LimitDashpots(timestep(), &system)) return system;
  const StabilityBound bound = ComputeStabilityBound(system);
  const double limit = LimitsOfStages(system.dashpot_stages).stiffness;
  system.stiffness *= limit * std::pow(kStiffest / (timestep() * bound.omega_max), 2);
  LimitDashpots(timestep(), &system);
  return system;
}

Eigen::VectorXd SmoothBody::NearestStiffnesses(const SpringMassSystem& system) const {
  constexpr double kDeviation = 0.3;  // of a logarithm, where a spring is of the mean stiffness
  constexpr double kSoftest = 1e-3;   // of the mean: softer springs count as this soft
  const double mean = system.stiffness.mean();
  const Eigen::ArrayXd stiffness = system.stiffness.array().max(kSoftest * mean);
  const Eigen::ArrayXd weight = stiffness / mean / (kDeviation * kDeviation);
  const Eigen::ArrayXd base = factors_.base().stiffness.array();
  Eigen::MatrixXd slope(stiffness.size(), size());  // logarithms are linear in x
  for (int i = 0; i < size(); ++i) {
    slope.col(i) =
        (factors_.Apply(Eigen::VectorXd::Unit(size(), i)).stiffness.array() / base).log();
  }
  const Eigen::MatrixXd weighted = slope.transpose() * weight.matrix().asDiagonal();
  const Eigen::MatrixXd normal = weighted * slope + Precision(Eigen::VectorXd::Zero(size()));
  return normal.ldlt().solve(weighted * (stiffness / base).log().matrix());
}

Eigen::VectorXd SmoothBody::NumbersLike(const SpringMassSystem& system,
                                        const Eigen::VectorXd& x) const {
  Eigen::VectorXd like = NearestStiffnesses(system);
  // of the common numbers, the first two are of stiffness, the object's and the hands'
  for (int i = 2; i < factors_.first_class(); ++i) like[i] = x[i];
  // those of `x` may be longer: where the body is limited, they are not what was simulated
  const SpringMassSystem now = factors_.Apply(like);
  for (bool hands : {false, true}) {
    const double longer = MeanLogLoss(system, hands) - MeanLogLoss(now, hands);
    if (std::isfinite(longer)) like[hands ? 3 : 2] += longer;
  }
  return like;
}

SpringMassSystem SmoothBody::NearestTo(const SpringMassSystem& system) const {
  const Eigen::VectorXd x = NearestStiffnesses(system);
  SpringMassSystem nearest = system;
  nearest.rest_length = factors_.base().rest_length;
  nearest.stiffness = factors_.Apply(x).stiffness;
  nearest.dashpot = nearest.stiffness * (system.dashpot.sum() / system.stiffness.sum());
  return nearest;
}

bool SmoothBody::IsLimited(const Eigen::VectorXd& x) const {
  const SpringMassSystem system = factors_.Apply(x);
  return ComputeStabilityBound(system).CheapestTimestep(system.dashpot_stages) < timestep();
}

}  // namespace physpring
