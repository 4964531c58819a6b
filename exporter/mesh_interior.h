// SPDX-License-Identifier: Apache-2.0
// Particles inside a mesh: what a camera cannot see of a solid object. Inside is where the winding
// number, the solid angle under which the faces are seen over 4 pi, is more than 1/2 (Jacobson,
// Kavan, Sorkine-Hornung, Robust Inside-Outside Segmentation, 2013): small holes do not matter.
#ifndef PHYSPRING_EXPORTER_MESH_INTERIOR_H_
#define PHYSPRING_EXPORTER_MESH_INTERIOR_H_

#include "exporter/triangle_mesh.h"

namespace physpring {

// 1 inside a closed mesh, 0 outside, in between near holes; -1 inside one that is inside out.
double WindingNumber(const TriangleMesh& mesh, const Eigen::Vector3d& x);

// The points of a cubic lattice that are inside the mesh and at least half a `spacing` (m, > 0)
// away from its vertices and from the points `taken` (3 x points, m). Throws Error if the lattice
// has more than a million points.
Points SampleInterior(const TriangleMesh& mesh, double spacing, const Points& taken);

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_MESH_INTERIOR_H_
