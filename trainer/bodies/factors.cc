// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/factors.h"

#include <cmath>

#include "trainer/bodies/spring_net.h"

namespace physpring {
namespace {

constexpr double kMostSubsteps = 10000;  // a second

// Standard deviations of the prior on the springs' own parts.
constexpr double kOwnStiffness = 0.5, kOwnDashpot = 0.5, kOwnRestLength = 0.01;

// What one entry of x is expected to move by, and how strongly it acts beside a log-stiffness.
struct EntryScale {
  double deviation, scale;
};

EntryScale ScaleOf(Parameters::Kind kind) {
  switch (kind) {
    case Parameters::Kind::kGlobal:
    case Parameters::Kind::kClassDashpot:
    case Parameters::Kind::kMode:
      return {3, 30};
    case Parameters::Kind::kStiffness:
      return {kOwnStiffness, 1};
    case Parameters::Kind::kDashpot:
      return {kOwnDashpot, 1};
    case Parameters::Kind::kRestLength:
      return {kOwnRestLength, 100};
  }
  return {};
}

}  // namespace

ParameterOptions CommonOptions(const SpringMassSystem& base, const Recording& recording,
                               const BodyKind& kind) {
  ParameterOptions options;
  options.spring_stiffness = options.spring_dashpot = options.spring_rest_length = false;
  options.contact = recording.ground.has_value();
  kind.Free(base, &options);
  return options;
}

Parameters CommonFactors(const SpringMassSystem& base, const Recording& recording,
                         const BodyKind& kind) {
  return {base, CommonOptions(base, recording, kind)};
}

Parameters SpringFactors(const SpringMassSystem& base, const Recording& recording,
                         const BodyKind& kind) {
  ParameterOptions options = CommonOptions(base, recording, kind);
  options.spring_stiffness = options.spring_dashpot = options.spring_rest_length = true;
  return {base, options};
}

Parameters StiffnessFactors(const SpringMassSystem& base, const Recording& recording,
                            const BodyKind& kind) {
  ParameterOptions options = CommonOptions(base, recording, kind);
  options.spring_stiffness = options.loss_times = true;
  options.class_dashpots = false;
  return {base, options};
}

GaussNewtonOptions SpringPrior(const Parameters& parameters) {
  GaussNewtonOptions options;
  options.conjugate_gradient_steps = 50;
  options.precision.resize(parameters.size());
  options.scale.resize(parameters.size());
  for (int i = 0; i < parameters.size(); ++i) {
    const EntryScale entry = ScaleOf(parameters.kind(i));
    options.precision[i] = 1 / (entry.deviation * entry.deviation);
    options.scale[i] = entry.scale;
  }
  return options;
}

double FactorDifference(const Recording& recording) { return recording.ground ? 1e-2 : 1e-3; }

double DirectionDifference(const Recording& recording, bool single_precision) {
  return recording.ground || single_precision ? 1e-3 : 1e-5;
}

double MostRate(const TrainOptions& options, const Recording& recording) {
  return options.substeps > 0 ? options.substeps * recording.fps : kMostSubsteps;
}

MotionProblem::Options FollowOptions(const Recording& recording, const Body& body,
                                     const TrainOptions& options) {
  MotionProblem::Options problem;
  problem.rollout.single_precision = options.single_precision;
  problem.rollout.controller_velocity = body.controller_velocity;
  problem.rollout.substeps = options.substeps;
  problem.most_substeps = static_cast<int>(std::ceil(kMostSubsteps / recording.fps));
  problem.difference = DirectionDifference(recording, options.single_precision);
  problem.threads = options.threads;
  return problem;
}

}  // namespace physpring
