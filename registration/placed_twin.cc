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
  recording.points = {system.position.leftCols(twin.points)};
  recording.interior = system.position.middleCols(twin.points, twin.interior);
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
  Recording placed = WithParticles(clouds, start, reference.rest, twin.interior);
  placed.rest_given = true;
  placed.rod = twin.rod;
  return placed;
}

}  // namespace physpring
