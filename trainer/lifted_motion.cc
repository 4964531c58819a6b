// SPDX-License-Identifier: Apache-2.0
#include "trainer/lifted_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trainer/parallel.h"
#include "twin/hierarchy.h"

namespace physpring {
namespace {

// What a rollout of the level's nodes, and, where there is one, an observer of it need of the
// recording.
Recording ForNodes(const Twin& twin, int level, const Recording& recording, bool observed) {
  Recording carried;
  carried.name = recording.name;
  carried.controllers = recording.controllers;
  carried.fps = recording.fps;
  carried.gravity = recording.gravity;
  carried.ground = recording.ground;
  const int particles = recording.particle_count(), controllers = recording.controller_count();
  const Points nodes = AverageOverMembers(twin, level, recording.start.leftCols(particles));
  carried.start.resize(3, nodes.cols() + controllers);
  carried.start << nodes, recording.start.rightCols(controllers);
  carried.velocity = AverageOverMembers(twin, level, recording.velocity);
  if (!observed) return carried;
  // measured where all of a node's members are
  for (const Points& measured : recording.points) {
    Points all = Points::Constant(3, particles, std::numeric_limits<double>::quiet_NaN());
    all.leftCols(measured.cols()) = measured;
    carried.points.push_back(AverageOverMembers(twin, level, all));
  }
  return carried;
}

}  // namespace

LiftedMotion::LiftedMotion(const Twin& twin, int level, const std::vector<Episode>& episodes,
                           const Options& options)
    : episodes_(episodes), options_(options) {
  for (const Episode& episode : episodes) {
    const Recording& recording = *episode.recording;
    carried_.push_back(ForNodes(twin, level, recording, options.rollout.observer_gain > 0));
    lifts_.emplace_back(twin, level, recording.start.leftCols(recording.particle_count()));
  }
}

void LiftedMotion::ForEachFrame(const std::function<void(int, int)>& work) const {
  std::vector<std::array<int, 2>> frames;
  for (int e = 0; e < episode_count(); ++e) {
    for (int frame = 0; frame < episodes_[e].frames; ++frame) frames.push_back({e, frame});
  }
  ParallelFor(static_cast<int>(frames.size()), options_.threads,
              [&](int i) { work(frames[i][0], frames[i][1]); });
}

int LiftedMotion::Substeps(const SpringMassSystem& system) const {
  if (options_.rollout.substeps > 0) return options_.rollout.substeps;
  const StabilityBound bound = ComputeStabilityBound(system);
  int substeps = 1;
  for (const Recording& recording : carried_) {
    substeps = std::max(substeps, StableSubsteps(bound, 1 / recording.fps, options_.safety));
  }
  return substeps > options_.most_substeps ? 0 : substeps;
}

std::optional<LiftedMotion::Motion> LiftedMotion::Run(const SpringMassSystem& system,
                                                      int substeps) const {
  if (substeps == 0) return {};
  RolloutOptions rollout = options_.rollout;
  rollout.substeps = substeps;
  rollout.threads = episode_count() == 1 ? options_.threads : 1;
  Motion motion;
  motion.rollouts.resize(episodes_.size());
  motion.particles.resize(episodes_.size());
  ParallelFor(episode_count(), options_.threads, [&](int e) {
    motion.rollouts[e] = RollOut(system, {&carried_[e], episodes_[e].frames}, rollout);
    motion.particles[e].resize(episodes_[e].frames);
  });
  for (const auto& one : motion.rollouts) {
    if (one->diverged()) return {};
  }
  ForEachFrame([&](int e, int frame) {
    motion.particles[e][frame] = lifts_[e].Apply(motion.rollouts[e]->positions()[frame]);
  });
  return motion;
}

SystemGradient LiftedMotion::Adjoint(const SpringMassSystem& system, const Motion& motion,
                                     const Frames& particles_bar, int* cuts) const {
  Frames nodes_bar = particles_bar;
  ForEachFrame([&](int e, int frame) {
    nodes_bar[e][frame] =
        lifts_[e].Adjoint(motion.rollouts[e]->positions()[frame], particles_bar[e][frame]);
  });
  std::vector<std::optional<RolloutAdjoint>> adjoints(episodes_.size());
  ParallelFor(episode_count(), options_.threads,
              [&](int e) { adjoints[e] = motion.rollouts[e]->Adjoint(nodes_bar[e]); });
  SystemGradient sum(system);
  if (cuts) *cuts = 0;
  for (const auto& adjoint : adjoints) {
    sum += adjoint->gradient;
    if (cuts) *cuts += adjoint->cuts;
  }
  return sum;
}

LiftedMotion::Frames LiftedMotion::ZerosLike(const Frames& particles) {
  Frames zeros = particles;
  for (auto& frames : zeros) {
    for (Points& frame : frames) frame.setZero();
  }
  return zeros;
}

std::optional<double> MeanTrackError(const std::vector<Points>& particles,
                                     const Recording& recording, int first, int last) {
  double sum = 0;
  int frames = 0;
  for (int frame = first; frame < last; ++frame) {
    const Points& measured = recording.points[frame];
    double distance = 0;
    int seen = 0;
    for (int i = 0; i < measured.cols(); ++i) {
      if (std::isnan(measured(0, i))) continue;
      distance += (particles[frame].col(i) - measured.col(i)).norm();
      ++seen;
    }
    if (seen == 0) continue;
    sum += distance / seen;
    ++frames;
  }
  if (frames == 0) return {};
  return sum / frames;
}

}  // namespace physpring
