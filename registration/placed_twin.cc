// SPDX-License-Identifier: Apache-2.0
#include "registration/placed_twin.h"

#include "registration/followed_body.h"

namespace physpring {

Recording ReferenceOf(const Twin& twin) {
  const SpringMassSystem& system = twin.levels[0].system;
  Recording recording;
  recording.name = twin.name;
  recording.fps = twin.fps;
  recording.mass = system.mass.sum();
  recording.gravity = twin.gravity;
  recording.points = {system.position.leftCols(system.node_count())};
  recording.controllers = {system.position.rightCols(system.controllers)};
  recording.start = recording.rest = system.position;
  recording.rest_given = true;
  recording.velocity = Points::Zero(3, system.node_count());
  recording.rod = twin.rod;
  recording.train_frames = 1;
  return recording;
}

Recording PlaceTwin(const Twin& twin, const Recording& clouds) {
  const Recording reference = ReferenceOf(twin);
  const Points start = CarryOver(reference, clouds);
  Recording placed = WithParticles(clouds, start, reference.rest);
  placed.rest_given = true;
  placed.rod = twin.rod;
  placed.interior = start.rightCols(twin.interior);
  for (Points& points : placed.points) points = Points(points.leftCols(twin.points));
  return placed;
}

}  // namespace physpring
