// SPDX-License-Identifier: Apache-2.0
#include "trainer/motion/lifted_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "trainer/motion/lane_rollout.h"
#include "twin/hierarchy.h"
#include "twin/lane_simulator.h"
#include "twin/parallel.h"

namespace physpring {
namespace {

// Sub-step as a part of the largest stable one, at most, where the number of sub-steps is given.
constexpr double kLargestSafety = 0.95;

// What a rollout of the level's nodes needs of the recording, and an observer of it, where there is
// one.
Recording ForNodes(const Twin& twin, int level, const Recording& recording, bool observed) {
  Recording carried;
  carried.name = recording.name;
  carried.controllers = recording.controllers;
  carried.held = recording.held;
  carried.fps = recording.fps;
  carried.gravity = recording.gravity;
  carried.ground = recording.ground;
  const int particles = recording.particle_count(), controllers = recording.controller_count();
  const Points nodes = AverageOverMembers(twin, level, recording.start.leftCols(particles));
  carried.start.resize(3, nodes.cols() + controllers);
  carried.start << nodes, recording.start.rightCols(controllers);
  carried.velocity = AverageOverMembers(twin, level, recording.velocity);
  for (const auto& [frame, shape] : recording.shape_when_held) {
    carried.shape_when_held[frame] = AverageOverMembers(twin, level, shape);
  }
  if (!observed) return carried;
  // a node is measured where all of its members are
  for (const Points& measured : recording.points) {
    Points all = Points::Constant(3, particles, std::numeric_limits<double>::quiet_NaN());
    all.leftCols(measured.cols()) = measured;
    carried.points.push_back(AverageOverMembers(twin, level, all));
  }
  return carried;
}

}  // namespace

LiftedMotion::LiftedMotion(std::vector<Episode> episodes, const Options& options)
    : episodes_(std::move(episodes)), options_(options) {
  options_.rollout.threads = ThreadsOfOne();
}

LiftedMotion::LiftedMotion(const Twin& twin, int level, std::vector<Episode> episodes,
                           const Options& options)
    : LiftedMotion(std::move(episodes), options) {
  for (const Episode& episode : episodes_) {
    const Recording& recording = *episode.recording;
    carried_.push_back(ForNodes(twin, level, recording, options.rollout.observer_gain > 0));
    lifts_.emplace_back(twin, level, recording.start.leftCols(recording.particle_count()));
  }
}

LiftedMotion::Substeps LiftedMotion::SubstepsOf(const SpringMassSystem& system) const {
  Substeps substeps;
  if (episodes_.empty()) return substeps;
  const int given = options_.rollout.substeps;
  if (given > 0) {
    // the longest sub-steps need the most stages
    double least_fps = std::numeric_limits<double>::infinity();
    for (const Episode& episode : episodes_) {
      least_fps = std::min(least_fps, episode.recording->fps);
    }
    substeps.counts.assign(episodes_.size(), given);
    substeps.dashpot_stages = CutFrames(1 / least_fps, given, system).dashpot_stages;
    return substeps;
  }
  const StabilityBound bound = ComputeStabilityBound(system);
  const double first_fps = episodes_[0].recording->fps;
  substeps.dashpot_stages =
      CheapestCut(bound, 1 / first_fps, options_.safety, system.dashpot_stages).dashpot_stages;
  const double timestep = bound.TimestepOf(substeps.dashpot_stages);
  for (const Episode& episode : episodes_) {
    const double fps = episode.recording->fps;
    const int needed = StableSubsteps(timestep, 1 / fps, options_.safety);
    const double plain = needed * CostOf(substeps.dashpot_stages);
    if (plain > options_.most_substeps || plain * fps > options_.most_rate) return {};
    substeps.counts.push_back(
        std::max(needed, static_cast<int>(std::ceil(options_.least_rate / fps))));
  }
  return substeps;
}

bool LiftedMotion::AreEnough(const Substeps& substeps, const SpringMassSystem& system) const {
  const double cost = CostOf(substeps.dashpot_stages);
  const auto are_enough_for = [&](const StabilityBound& bound) {
    const double timestep = bound.TimestepOf(substeps.dashpot_stages);
    for (std::size_t e = 0; e < substeps.counts.size(); ++e) {
      const double fps = episodes_[e].recording->fps;
      if (StableSubsteps(timestep, 1 / fps, kLargestSafety) > substeps.counts[e]) return false;
      const int needed = StableSubsteps(timestep, 1 / fps, options_.safety);
      if (needed * cost * fps > options_.most_rate) return false;
    }
    return true;
  };
  return are_enough_for(RoughStabilityBound(system)) ||
         are_enough_for(ComputeStabilityBound(system));
}

RolloutOptions LiftedMotion::RolloutOf(int e, const Substeps& substeps) const {
  RolloutOptions options = options_.rollout;
  options.substeps = substeps.counts[e];
  return options;
}

SpringMassSystem LiftedMotion::BeforeChange(SpringMassSystem system) const {
  system.effects.resize(std::min(options_.lasting_effects, system.effects.size()));
  return system;
}

Episode LiftedMotion::EpisodeOfNodes(int e) const {
  const Episode& episode = episodes_[e];
  const Recording* recording = carried_.empty() ? episode.recording : &carried_[e];
  return {recording, episode.frames, episode.use};
}

std::vector<Points> LiftedMotion::Lifted(int e, const std::vector<Points>& positions) const {
  std::vector<Points> lifted(positions.size());
  ParallelFor(static_cast<int>(lifted.size()), ThreadsOfOne(),
              [&](int frame) { lifted[frame] = lifts_[e].Apply(positions[frame]); });
  return lifted;
}

std::optional<LiftedMotion::Motion> LiftedMotion::RunOne(int e, const SpringMassSystem& system,
                                                         const Substeps& substeps) const {
  Motion motion;
  if (episodes_[e].frames < 2) return motion;
  SpringMassSystem moved = episodes_[e].before_change ? BeforeChange(system) : system;
  moved.dashpot_stages = substeps.dashpot_stages;
  motion.rollout = RollOut(moved, EpisodeOfNodes(e), RolloutOf(e, substeps));
  if (motion.rollout->diverged()) return {};
  if (!lifts_.empty()) motion.lifted = Lifted(e, motion.rollout->positions());
  return motion;
}

std::vector<std::optional<std::vector<Points>>> LiftedMotion::RunSideBySide(
    int e, std::vector<SpringMassSystem> systems, const Substeps& substeps) const {
  if (episodes_[e].frames < 2) return {systems.size(), std::vector<Points>()};
  for (SpringMassSystem& system : systems) system.dashpot_stages = substeps.dashpot_stages;
  if (!episodes_[e].before_change) return RunAll(e, systems, substeps);
  // systems that differ in new effects alone move alike before the change: each goes once
  std::vector<SpringMassSystem> unlike;
  std::vector<std::size_t> place;
  for (const SpringMassSystem& system : systems) {
    SpringMassSystem before = BeforeChange(system);
    const auto same = std::find_if(unlike.begin(), unlike.end(), [&](const SpringMassSystem& one) {
      return AreAlike(one, before) && one == before;
    });
    place.push_back(same - unlike.begin());
    if (same == unlike.end()) unlike.push_back(std::move(before));
  }
  const auto particles = RunAll(e, unlike, substeps);
  std::vector<std::optional<std::vector<Points>>> all;
  for (std::size_t i : place) all.push_back(particles[i]);
  return all;
}

std::vector<std::optional<std::vector<Points>>> LiftedMotion::RunAll(
    int e, const std::vector<SpringMassSystem>& systems, const Substeps& substeps) const {
  auto all = RollOutSideBySide(systems, EpisodeOfNodes(e), RolloutOf(e, substeps));
  if (lifts_.empty()) return all;
  for (std::optional<std::vector<Points>>& particles : all) {
    if (particles) particles = Lifted(e, *particles);
  }
  return all;
}

std::optional<std::vector<LiftedMotion::Motion>> LiftedMotion::Run(const SpringMassSystem& system,
                                                                   const Substeps& substeps) const {
  if (substeps.empty()) return {};
  std::vector<std::optional<Motion>> motions(episodes_.size());
  ParallelFor(episode_count(), options_.threads,
              [&](int e) { motions[e] = RunOne(e, system, substeps); });
  std::vector<Motion> all;
  for (auto& motion : motions) {
    if (!motion) return {};
    all.push_back(std::move(*motion));
  }
  return all;
}

SystemGradient LiftedMotion::Adjoint(const SpringMassSystem& system,
                                     const std::vector<Motion>& motions,
                                     const ParticlesBar& particles_bar, int* cuts) const {
  std::vector<std::optional<RolloutAdjoint>> adjoints(episodes_.size());
  ParallelFor(episode_count(), options_.threads, [&](int e) {
    Rollout* rollout = motions[e].rollout.get();
    if (!rollout) return;
    std::vector<Points> bars = particles_bar(e);
    if (!lifts_.empty()) {
      ParallelFor(static_cast<int>(bars.size()), ThreadsOfOne(), [&](int frame) {
        bars[frame] = lifts_[e].Adjoint(rollout->positions()[frame], bars[frame]);
      });
    }
    adjoints[e] = rollout->Adjoint(bars);
  });
  SystemGradient sum(system);
  if (cuts) *cuts = 0;
  for (const auto& adjoint : adjoints) {
    if (!adjoint) continue;
    sum += adjoint->gradient;
    if (cuts) *cuts += adjoint->cuts;
  }
  return sum;
}

std::vector<Points> LiftedMotion::ZerosLike(std::vector<Points> frames) {
  for (Points& frame : frames) frame.setZero();
  return frames;
}

}  // namespace physpring
