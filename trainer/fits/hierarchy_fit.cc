// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/hierarchy_fit.h"

#include <fmt/format.h>

#include <cmath>

#include "trainer/fits/level_fit.h"
#include "trainer/network/graph_network.h"
#include "trainer/projection/galerkin.h"
#include "trainer/reduction/registry.h"
#include "twin/error.h"
#include "twin/hierarchy.h"

namespace physpring {
namespace {

constexpr double kReductionShare = 0.15;  // of a level's work

// Away from the ground; where there is none, against gravity.
Eigen::Vector3d Up(const Recording& recording) {
  if (recording.ground) return recording.ground->head<3>().normalized();
  return recording.gravity.norm() > 0 ? Eigen::Vector3d(-recording.gravity.normalized())
                                      : Eigen::Vector3d::UnitZ();
}

int NodesOfLevel(int level, int particles, const TrainOptions& options) {
  return static_cast<int>(std::lround(options.ratios.at(level - 1) * particles));
}

Twin WithNextLevel(const Twin& below, const Assignment& assignment, const Eigen::Vector3d& up) {
  Twin twin = below;
  twin.levels.push_back(
      {Project(below.levels.back().system, assignment, up).system, assignment, 0});
  SpreadRod(&twin);
  return twin;
}

}  // namespace

void ExpectCoarserLevels(const FitData& data, const TrainOptions& options) {
  const int particles = data.recordings.at(0).particle_count();
  int below = particles;
  for (int level = 1; level < options.levels; ++level) {
    const int nodes = NodesOfLevel(level, particles, options);
    if (nodes < 2 || nodes >= below) {
      throw Error(
          fmt::format("--ratios {}: level {} of {} particles would have {} nodes, expected 2 to {}",
                      options.ratios[level - 1], level, particles, nodes, below - 1));
    }
    below = nodes;
  }
}

Twin FitHierarchy(const Twin& dense, const FitData& data, const TrainOptions& options,
                  const Work& work) {
  const Reduction& reduction = GetReduction(options.reduction);
  const GraphNetwork network(options.network.latent, options.seed);
  const Eigen::Vector3d up = Up(data.recordings[0]);
  Eigen::VectorXd weights = network.first_weights();  // as the last level left them
  Twin twin = dense;
  const int particles = dense.levels[0].system.node_count();
  const double share = 1.0 / std::max(1, options.levels - 1);
  for (int level = 1; level < options.levels; ++level) {
    const Work of_level =
        work.Part(fmt::format("level {}", level), (level - 1) * share, level * share);
    const Reduced reduced = reduction.Reduce(
        {twin, NodesOfLevel(level, particles, options), up, data, options, network, weights},
        of_level.Part("reduction", 0, kReductionShare));
    std::vector<Twin> candidates;
    for (const Assignment& assignment : reduced.candidates) {
      candidates.push_back(WithNextLevel(twin, assignment, up));
    }
    const FittedLevel fitted = FitLevel(data, options, candidates, network, reduced.weights,
                                        of_level.Part("fit", kReductionShare, 1));
    twin.levels.push_back(fitted.level);
    weights = fitted.weights;
    work.Reached(twin);
  }
  return twin;
}

}  // namespace physpring
