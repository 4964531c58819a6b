// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_EXPORTER_MESH_SAMPLES_H_
#define PHYSPRING_EXPORTER_MESH_SAMPLES_H_

#include "exporter/triangle_mesh.h"

namespace physpring {

// Points on the faces of the mesh, of each in proportion to its area: 3 x `count` (>= 1), m. They
// are the same each time. Throws Error where all faces together have no area.
Points SampleSurface(const TriangleMesh& mesh, int count);

// Points on the faces that are farther than `spacing` (m, > 0) from the points `taken` (3 x points,
// m, one or more) and from each other, until every place of the faces is nearer to one of them.
// Each is the farthest from those before it (Gonzalez, Theoretical Computer Science 38, 1985).
// Throws Error as SampleSurface does, and where more than ten thousand would be needed.
Points SampleBare(const TriangleMesh& mesh, double spacing, const Points& taken);

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_MESH_SAMPLES_H_
