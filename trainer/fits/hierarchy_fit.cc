// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/hierarchy_fit.h"

#include <fmt/format.h>

#include <cmath>

#include "trainer/fits/level_fit.h"
#include "trainer/fits/topology_fit.h"
#include "trainer/network/graph_network.h"
#include "trainer/reduction/baselines.h"
#include "trainer/reduction/galerkin.h"
#include "trainer/reduction/gramian.h"
#include "twin/error.h"
#include "twin/hierarchy.h"

namespace physpring {
namespace {

constexpr double kTopologyShare = 0.15;  // of a level's work

// Null for a reduction that is learned.
Reduction ReductionOf(TrainOptions::Reduction method) {
  switch (method) {
    case TrainOptions::Reduction::kLearned:
      return nullptr;
    case TrainOptions::Reduction::kRandom:
      return RandomAssignment;
    case TrainOptions::Reduction::kGramian:
      return GramianAssignment;
    case TrainOptions::Reduction::kKMeans:
      return KMeansAssignment;
  }
  return nullptr;
}

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
  SpreadOrder(&twin);
  return twin;
}

// An assignment that is drawn in one step.
struct Drawn {
  Assignment assignment;

  template <class Visitor>
  void Visit(Visitor&& visit) {
    visit(assignment);
  }
};

// The assignments that the next level may have; a learned reduction learns the weights on.
std::vector<Assignment> Reduce(const Twin& twin, const FitData& data, const TrainOptions& options,
                               const GraphNetwork& network, Eigen::VectorXd* weights,
                               const Work& work) {
  const int level = static_cast<int>(twin.levels.size());
  const int nodes = NodesOfLevel(level, twin.levels[0].system.node_count(), options);
  const Reduction reduce = ReductionOf(options.reduction);
  if (reduce) {
    const std::uint64_t seed = options.seed * 1000 + static_cast<std::uint64_t>(level);
    const auto draw = [&](Drawn* drawn) -> StepReport {
      drawn->assignment = reduce(twin.levels.back().system, nodes, seed);
      return {true, 1, fmt::format("level {}: {} nodes", level, nodes)};
    };
    return {work.Follow(Drawn(), draw).assignment};
  }
  const TopologyFit start(data, options, twin, network, *weights, nodes, Up(data.recordings[0]));
  const TopologyFit topology = work.Follow(start, [](TopologyFit* fit) -> StepReport {
    fit->Step();
    return {fit->done(), fit->Progress(), fit->Status()};
  });
  *weights = topology.weights();
  return topology.candidates();
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
  const GraphNetwork network(options.network.latent, options.seed);
  Eigen::VectorXd weights = network.first_weights();  // as the last level left them
  Twin twin = dense;
  const double share = 1.0 / std::max(1, options.levels - 1);
  for (int level = 1; level < options.levels; ++level) {
    const Work of_level =
        work.Part(fmt::format("level {}", level), (level - 1) * share, level * share);
    std::vector<Twin> candidates;
    for (const Assignment& assignment : Reduce(twin, data, options, network, &weights,
                                               of_level.Part("reduction", 0, kTopologyShare))) {
      candidates.push_back(WithNextLevel(twin, assignment, Up(data.recordings[0])));
    }
    const FittedLevel fitted = FitLevel(data, options, candidates, network, weights,
                                        of_level.Part("fit", kTopologyShare, 1));
    twin.levels.push_back(fitted.level);
    weights = fitted.weights;
    work.Reached(twin);
  }
  return twin;
}

}  // namespace physpring
