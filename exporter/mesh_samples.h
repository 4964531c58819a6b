// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_EXPORTER_MESH_SAMPLES_H_
#define PHYSPRING_EXPORTER_MESH_SAMPLES_H_

#include "exporter/triangle_mesh.h"

namespace physpring {

// Points on the faces of the mesh, of each in proportion to its area: 3 x `count` (>= 1), m. They
// are the same each time. Throws Error where all faces together have no area.
Points SampleSurface(const TriangleMesh& mesh, int count);

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_MESH_SAMPLES_H_
