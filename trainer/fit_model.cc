// SPDX-License-Identifier: Apache-2.0
#include "trainer/fit_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "trainer/particle_mass.h"
#include "trainer/spring_radius.h"
#include "trainer/start_system.h"
#include "twin/effects/registry.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr double kMostSubsteps = 10000;  // a second
constexpr int kFewestNeighbours = 6;     // of a particle or controller that has few within reach
constexpr int kMostPerWanted = 4;        // neighbours, at most this many times those of inner ones

// Standard deviations of the prior on the springs' own parts.
constexpr double kOwnStiffness = 0.5, kOwnDashpot = 0.5, kOwnRestLength = 0.01;

// Strands that stick and slip make a chain's motions rough: longer differences see its slopes. And
// so many of their coordinates, one after the other, are off alike: they count as one.
constexpr double kChainDifference = 1e-2, kAlike = 30;

// What one entry of x is expected to move by, and how strongly it acts beside a log-stiffness.
struct EntryScale {
  double deviation, scale;
};

EntryScale ScaleOf(Parameters::Kind kind) {
  switch (kind) {
    case Parameters::Kind::kGlobal:
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

std::vector<int> NeighbourCounts(const Recording& recording, const TrainOptions& options) {
  std::vector<int> counts = options.neighbours;
  if (counts.empty()) {
    counts = recording.order.size() > 0 ? std::vector<int>{12, 20} : std::vector<int>{18, 28, 40};
  }
  // more neighbours than there are particles are all the same
  const int most = std::max(1, recording.particle_count() - 1);
  for (int& count : counts) count = std::min(count, most);
  std::sort(counts.begin(), counts.end());
  counts.erase(std::unique(counts.begin(), counts.end()), counts.end());
  return counts;
}

// Where the curvature of a rod of length l that slips begins to matter, kSlip / l.
constexpr double kSlip = 5;

double RodLength(const Eigen::VectorXd& order) { return order.maxCoeff() - order.minCoeff(); }

// A chain of nodes that bends as a rod does: with stiffness, friction between its strands, and a
// shape of its own, unless effects of bending are known. They start from what would matter to a rod
// of this length l and weight m g: a rigidity of kRigidity m g l^2, and kFriction of its moment at
// the curvature where it slips. A little damping, which is not fitted, calms the shortest waves,
// at the rate kCalm; more of it would serve fits under an observer, but not free motions.
Candidate BendingChain(const Recording& recording, Candidate candidate) {
  candidate.neighbours = 2;
  if (std::any_of(candidate.effects.begin(), candidate.effects.end(),
                  [](const auto& effect) { return GetEffect(effect.name).bends(); })) {
    return candidate;
  }
  constexpr double kRigidity = 3e-3, kFriction = 0.3, kCalm = 100;  // kCalm: 1/s
  const double length = RodLength(recording.order);
  const double spacing = length / static_cast<double>(recording.order.size() - 1);
  const double gravity = recording.gravity.norm() > 0 ? recording.gravity.norm() : 9.81;
  const double rigidity = kRigidity * recording.mass * gravity * length * length;
  const double friction = kFriction * rigidity * kSlip / length;
  // of an even chain of nodes of mass m at distances l: 16 D / (m l^3)
  const double node_mass = recording.mass / static_cast<double>(recording.particle_count());
  const double damping = kCalm * node_mass * std::pow(spacing, 3) / 16;
  candidate.effects.push_back({"bending_damping", Eigen::VectorXd::Constant(1, damping)});
  candidate.effects.push_back({"bending", Eigen::VectorXd::Constant(1, rigidity)});
  candidate.effects.push_back({"bending_friction", Eigen::Vector2d(friction, kSlip / length)});
  candidate.effects.push_back(
      {"rest_bend", Eigen::VectorXd::Zero(GetEffect("rest_bend").value_count())});
  candidate.effects.push_back({"twist", Eigen::Vector2d(rigidity, 0)});
  candidate.free_effects = 4;
  return candidate;
}

// The last effects, those of a chain, are fitted: the moments of its own shape in units of the one
// with which its stiffness answers to the curvature where it slips. Its springs are all alike, and
// how they are damped along it hardly matters: fitted, that would ask for all sub-steps there are.
void SetFreeEffects(const SpringMassSystem& base, int free_effects, ParameterOptions* options) {
  options->free_effects = free_effects;
  if (free_effects == 0) return;
  options->length_classes = options->dashpots = false;
  const EffectValues& bending = *(base.effects.end() - free_effects);
  const double moment = bending.values[0] * kSlip / RodLength(base.order);
  options->moment_unit = moment / GetEffect("rest_bend").parameters()[0].scale;
}

}  // namespace

std::string Candidate::Label() const {
  return fmt::format("{} neighbours{}{}{}", neighbours, is_chain() ? " and bending" : "",
                     controller_velocity ? "" : ", controllers without velocity",
                     cone == FrictionCone::kElliptic ? "" : ", pyramidal friction");
}

std::vector<Candidate> Candidates(const Recording& recording, const TrainOptions& options) {
  const Points particles = recording.rest.leftCols(recording.particle_count());
  std::vector<bool> velocities = {true, false};
  if (options.controller_velocity) velocities = {*options.controller_velocity};
  if (recording.controller_count() == 0) velocities.resize(1);
  std::vector<FrictionCone> cones = {FrictionCone::kElliptic};
  if (recording.ground) cones.push_back(FrictionCone::kPyramidal);
  if (options.cone) cones = {*options.cone};
  const Eigen::VectorXd masses = ParticleMasses(recording);
  std::vector<Candidate> candidates;
  double last_radius = 0;
  for (int count : NeighbourCounts(recording, options)) {
    const bool rod = recording.order.size() > 0 || particles.cols() < 2;
    const double radius = rod ? 0 : SpringRadius(particles, count);
    if (!rod && radius < 1.02 * last_radius) continue;  // the same shells again
    last_radius = radius;
    for (FrictionCone cone : cones) {
      for (bool velocity : velocities) {
        candidates.push_back({count, radius, velocity, cone, options.effects, masses});
      }
    }
  }
  if (recording.order.size() > 0 && options.neighbours.empty()) {
    candidates.push_back(BendingChain(recording, candidates[0]));
  }
  return candidates;
}

SpringMassSystem StartSystem(const Recording& recording, const Candidate& candidate,
                             double start_substeps) {
  TopologyOptions topology;
  topology.max_neighbours = topology.controller_max_neighbours = candidate.neighbours;
  if (candidate.radius > 0) {
    topology.radius = topology.controller_radius = candidate.radius;
    topology.min_neighbours = std::min(kFewestNeighbours, candidate.neighbours);
    topology.max_neighbours *= kMostPerWanted;
    topology.controller_max_neighbours *= kMostPerWanted;
  }
  SpringMassSystem system = MakeStartSystem(recording, topology);
  if (candidate.mass.size() > 0) system.mass = candidate.mass;
  system.contact.cone = candidate.cone;
  ScaleToSubsteps(1 / recording.fps, start_substeps, kStepSafety, &system);
  system.effects = candidate.effects;
  return system;
}

Parameters CommonFactors(const SpringMassSystem& base, const Recording& recording,
                         int free_effects) {
  ParameterOptions options;
  options.spring_stiffness = options.spring_dashpot = options.spring_rest_length = false;
  options.contact = recording.ground.has_value();
  SetFreeEffects(base, free_effects, &options);
  return {base, options};
}

Parameters SpringFactors(const SpringMassSystem& base, const Recording& recording,
                         int free_effects) {
  ParameterOptions options;
  options.spring_stiffness = options.spring_dashpot = options.spring_rest_length = true;
  options.contact = recording.ground.has_value();
  SetFreeEffects(base, free_effects, &options);
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

LevenbergMarquardtOptions FactorOptions(const Recording& recording, const Candidate& candidate) {
  LevenbergMarquardtOptions options;
  options.difference = candidate.is_chain() ? kChainDifference : FactorDifference(recording);
  if (candidate.is_chain()) options.precision *= kAlike;
  return options;
}

double DirectionDifference(const Recording& recording, bool single_precision) {
  return recording.ground || single_precision ? 1e-3 : 1e-5;
}

MotionProblem::Options FollowOptions(const Recording& recording, const Candidate& candidate,
                                     const TrainOptions& options) {
  MotionProblem::Options problem;
  problem.rollout.single_precision = options.single_precision;
  problem.rollout.controller_velocity = candidate.controller_velocity;
  problem.rollout.substeps = options.substeps;
  problem.most_substeps = static_cast<int>(std::ceil(kMostSubsteps / recording.fps));
  problem.difference = DirectionDifference(recording, options.single_precision);
  problem.threads = options.threads;
  return problem;
}

}  // namespace physpring
