// SPDX-License-Identifier: Apache-2.0
#include "tests/support/random_system.h"

#include "twin/topology.h"

namespace physpring {

SpringMassSystem RandomSystem(int nodes, int controllers, std::uint64_t seed) {
  Random random(seed);
  SpringMassSystem system;
  system.position = random.Box(nodes + controllers, 0.1);
  system.controllers = controllers;
  TopologyOptions options;
  options.max_neighbours = 6;
  options.controller_max_neighbours = 4;
  system.springs = BuildSprings(system.position, controllers, {}, options, "random");
  system.rest_length = SpringLengths(system.springs, system.position, {});
  system.stiffness.resize(system.spring_count());
  system.dashpot.resize(system.spring_count());
  for (int e = 0; e < system.spring_count(); ++e) {
    system.stiffness[e] = random(20, 60);
    system.dashpot[e] = random(0.02, 0.1);
    system.rest_length[e] *= random(0.8, 1.2);
  }
  system.mass.resize(nodes);
  for (double& mass : system.mass) mass = random(0.01, 0.03);
  system.drag = 0.5;
  system.contact_radius = Eigen::VectorXd::Constant(nodes, 0.005);
  return system;
}

}  // namespace physpring
