// SPDX-License-Identifier: Apache-2.0
#include "twin/free_twin.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "twin/error.h"
#include "twin/quote.h"

namespace physpring {
namespace {

void DropControllers(SpringMassSystem* system) {
  const int nodes = system->node_count();
  std::vector<int> kept;
  for (int e = 0; e < system->spring_count(); ++e) {
    const auto& [a, b] = system->springs[e];
    if (std::max(a, b) < nodes) kept.push_back(e);
  }
  const auto keep = [&](const Eigen::VectorXd& values) { return values(kept).eval(); };
  std::vector<std::array<int, 2>> springs;
  for (const int e : kept) springs.push_back(system->springs[e]);
  system->springs = std::move(springs);
  system->stiffness = keep(system->stiffness);
  system->rest_length = keep(system->rest_length);
  system->dashpot = keep(system->dashpot);
  system->position = system->position.leftCols(nodes).eval();
  system->controllers = 0;
  system->rod = RodOfNodes(system->rod, nodes);
}

}  // namespace

Twin WithoutControllers(Twin twin) {
  for (TwinLevel& level : twin.levels) {
    DropControllers(&level.system);
    if (level.system.springs.empty()) {
      throw Error(fmt::format("twin {}: without its controllers, a level has no springs",
                              Quote(twin.name)));
    }
  }
  const int nodes = twin.levels[0].system.node_count();
  twin.rod = RodOfNodes(twin.rod, nodes);
  twin.training_state.clear();
  twin.posterior = {};
  return twin;
}

}  // namespace physpring
