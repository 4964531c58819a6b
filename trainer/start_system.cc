// SPDX-License-Identifier: Apache-2.0
#include "trainer/start_system.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "twin/neighbours.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr double kStartDrag = 2;  // 1/s
constexpr double kStartRestitution = 0.1;
constexpr double kStartFriction = 0.5;

// Distance of the particles' centres from a surface they touch: the lowest height over the ground
// at which points are seen (1st percentile), if that is no more than the particles' spacing; 0
// where the body is never near the ground.
double ContactRadius(const Recording& recording) {
  if (!recording.ground) return 0;
  std::vector<double> heights;
  for (const Points& frame : recording.points) {
    for (int i = 0; i < frame.cols(); ++i) {
      const double height = recording.ground->head<3>().dot(frame.col(i)) - (*recording.ground)[3];
      if (!std::isnan(height)) heights.push_back(height);
    }
  }
  if (heights.empty()) return 0;
  const auto low = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 100);
  std::nth_element(heights.begin(), low, heights.end());
  const Points nodes = recording.start.leftCols(recording.particle_count());
  const std::vector<Neighbour> near = NeighbourSearch(nodes).Nearest(nodes.col(0), 2);
  const double spacing = near.size() > 1 ? near[1].distance : 0;
  return *low > 0 && *low < spacing ? *low : 0;
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
  const double omega = 2 * safety / h;
  const StabilityBound bound = ComputeStabilityBound(*system);
  system->stiffness *= omega * omega / (bound.omega_max * bound.omega_max);
  system->dashpot *= 0.5 * omega / bound.gamma_max;
}

}  // namespace physpring
