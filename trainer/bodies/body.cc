// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/body.h"

#include <fmt/format.h>

#include <algorithm>

#include "trainer/bodies/hanging_net.h"
#include "trainer/bodies/spring_radius.h"
#include "trainer/bodies/start_system.h"
#include "twin/dashpot_stages.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr int kFewestNeighbours = 6;  // so many are joined, however far, where few are within reach
constexpr int kMostPerWanted = 4;  // no particle has more than so many times the wanted neighbours

}  // namespace

std::string Body::Label() const {
  return fmt::format("{} neighbours{}{}{}{}", neighbours, kind->Addition(),
                     braced_joints ? "" : ", joints that bend",
                     controller_velocity ? "" : ", controllers without velocity",
                     cone == FrictionCone::kElliptic ? "" : ", pyramidal friction");
}

Body WithSoftSprings(const Body& body, const Recording& recording) {
  constexpr double kMore = 1.55;
  const Points particles = recording.rest.leftCols(recording.particle_count());
  const int count =
      std::min(static_cast<int>(kMore * body.neighbours), static_cast<int>(particles.cols()) - 1);
  const bool hangs = body.strain.size() > 0;  // its strains are of its own springs
  if (body.radius == 0 || hangs || count <= body.neighbours) return body;
  Body more = body;
  more.radius = std::max(body.radius, SpringRadius(particles, count));
  more.soft_beyond = body.radius;
  return more;
}

SpringMassSystem StartSystem(const Recording& recording, const Body& body, double start_substeps) {
  TopologyOptions topology;
  if (!body.braced_joints) topology.joint_reach = 0;
  topology.max_neighbours = topology.controller_max_neighbours = body.neighbours;
  if (body.radius > 0) {
    topology.radius = topology.controller_radius = body.radius;
    topology.min_neighbours = std::min(kFewestNeighbours, body.neighbours);
    topology.max_neighbours *= kMostPerWanted;
    topology.controller_max_neighbours *= kMostPerWanted;
  }
  SpringMassSystem system = MakeStartSystem(recording, topology);
  if (body.mass.size() > 0) system.mass = body.mass;
  system.contact.surface.cone = body.cone;
  if (body.kind->has_single_springs()) system.dashpot_stages = kMostDashpotStages;
  ScaleToSubsteps(1 / recording.fps, start_substeps, kStepSafety, &system);
  for (int e = 0; e < body.strain.size(); ++e) {
    const double ratio = RestRatio(body.stretch * body.strain[e]);
    system.rest_length[e] *= ratio;
    system.stiffness[e] /= ratio;
  }
  system.effects = body.effects;
  return system;
}

}  // namespace physpring
