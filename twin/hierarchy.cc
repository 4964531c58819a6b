// SPDX-License-Identifier: Apache-2.0
#include "twin/hierarchy.h"

#include <fmt/format.h>

#include <numeric>
#include <set>

#include "twin/error.h"

namespace physpring {

const TwinLevel& LevelOf(const Twin& twin, int level) {
  const int levels = static_cast<int>(twin.levels.size());
  if (level >= 0 && level < levels) return twin.levels[level];
  throw Error(
      fmt::format("twin {}: has no level {}, expected 0 to {}", twin.name, level, levels - 1));
}

std::vector<int> NodesOfParticles(const Twin& twin, int level) {
  LevelOf(twin, level);
  std::vector<int> nodes(twin.levels[0].system.node_count());
  std::iota(nodes.begin(), nodes.end(), 0);
  for (int l = 1; l <= level; ++l) {
    for (int& node : nodes) node = twin.levels[l].assignment.at(node);
  }
  return nodes;
}

std::vector<int> SurfaceNodes(const Twin& twin, int level) {
  const std::vector<int> nodes = NodesOfParticles(twin, level);
  const std::set<int> surface(nodes.begin(), nodes.begin() + twin.points);
  return {surface.begin(), surface.end()};
}

Points AverageOverMembers(const Twin& twin, int level, const Points& particles) {
  if (level == 0) return particles;
  const std::vector<int> nodes = NodesOfParticles(twin, level);
  const Eigen::VectorXd& mass = twin.levels[0].system.mass;
  const int count = twin.levels[level].system.node_count();
  Points sum = Points::Zero(3, count);
  Eigen::VectorXd total = Eigen::VectorXd::Zero(count);
  for (int i = 0; i < particles.cols(); ++i) {
    sum.col(nodes[i]) += mass[i] * particles.col(i);
    total[nodes[i]] += mass[i];
  }
  return sum.array().rowwise() / total.transpose().array();
}

void SpreadRod(Twin* twin) {
  for (std::size_t n = 0; n < twin->levels.size(); ++n) {
    SpringMassSystem& system = twin->levels[n].system;
    system.rod = n == 0 ? twin->rod
                        : CoarseRod(twin->rod, NodesOfParticles(*twin, static_cast<int>(n)),
                                    system.node_count());
  }
}

}  // namespace physpring
