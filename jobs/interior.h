// SPDX-License-Identifier: Apache-2.0
// A recording and a mesh of its object -> the recording with particles that no camera sees.
#ifndef PHYSPRING_JOBS_INTERIOR_H_
#define PHYSPRING_JOBS_INTERIOR_H_

#include <string>
#include <vector>

#include "twin/recording.h"

namespace physpring {

struct InteriorOptions {
  std::string mesh;       // file; its surface is where the recording's points are in frame 0
  double spacing = 0.01;  // of the particles inside, m
  bool surface = false;   // also on the surface where no point is
};

struct FilledRecording {
  Recording recording;  // its interior particles start at rest
  int on_surface = 0;   // of these
  std::vector<std::string> warnings;
};

// `path`: of the recording, for errors. Throws Error where nobody would know what the new particles
// are at rest, along a rod, or in which object; for a mesh that is elsewhere
// (exporter/mesh_place.h); and where no particle has place inside.
FilledRecording FillInterior(Recording recording, const std::string& path,
                             const InteriorOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_JOBS_INTERIOR_H_
