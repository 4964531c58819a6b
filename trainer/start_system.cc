// SPDX-License-Identifier: Apache-2.0
#include "trainer/start_system.h"

#include <cmath>
#include <vector>

#include "twin/neighbours.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr double kStartDrag = 2;  // 1/s
constexpr double kStartRestitution = 0.1;
constexpr double kStartFriction = 0.5;
constexpr double kDamping = 0.5;  // damping rate of the fastest mode, relative to its frequency

// Distance from the ground at which particles touch it: the lowest height in frame 0, if the body
// lies there (lower than the particles' spacing); 0 where it does not.
double ContactRadius(const Recording& recording) {
  if (!recording.ground) return 0;
  const Points nodes = recording.start.leftCols(recording.particle_count());
  const double lowest =
      (recording.ground->head<3>().transpose() * nodes).minCoeff() - (*recording.ground)[3];
  const std::vector<Neighbour> near = NeighbourSearch(nodes).Nearest(nodes.col(0), 2);
  const double spacing = near.size() > 1 ? near[1].distance : 0;
  return lowest > 0 && lowest < spacing ? lowest : 0;
}

}  // namespace

SpringMassSystem MakeStartSystem(const Recording& recording, const TopologyOptions& topology) {
  SpringMassSystem system;
  const int nodes = recording.particle_count();
  system.position = recording.rest;
  system.controllers = recording.controller_count();
  system.mass = Eigen::VectorXd::Constant(nodes, recording.mass / nodes);
  system.springs =
      BuildSprings(recording.rest, system.controllers, recording.order, topology, recording.name);
  system.rest_length = SpringLengths(system.springs, recording.rest, recording.order);
  system.stiffness = system.rest_length.cwiseInverse();
  system.dashpot = Eigen::VectorXd::Ones(system.spring_count());
  system.drag = kStartDrag;
  system.contact.restitution = kStartRestitution;
  system.contact.friction = kStartFriction;
  system.contact_radius = Eigen::VectorXd::Constant(nodes, ContactRadius(recording));
  return system;
}

void ScaleToSubsteps(double frame_time, double substeps, double safety, SpringMassSystem* system) {
  const double h = frame_time / substeps;
  // h / safety is the largest stable sub-step s: s^2 omega^2 + 2 s gamma = 4 (stability.h)
  const double omega = (std::sqrt(4 + kDamping * kDamping) - kDamping) * safety / h;
  const StabilityBound bound = ComputeStabilityBound(*system);
  system->stiffness *= omega * omega / (bound.omega_max * bound.omega_max);
  system->dashpot *= kDamping * omega / bound.gamma_max;
}

}  // namespace physpring
