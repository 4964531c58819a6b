// SPDX-License-Identifier: Apache-2.0
// A mesh from a file, put where the measured points are. Files differ in which axis is up and in
// their unit, and few say so. The points decide: they are on the surface of the right mesh.
#ifndef PHYSPRING_EXPORTER_MESH_PLACE_H_
#define PHYSPRING_EXPORTER_MESH_PLACE_H_

#include <string>
#include <vector>

#include "exporter/triangle_mesh.h"

namespace physpring {

struct PlacedMesh {
  TriangleMesh mesh;                  // m, z up
  std::vector<std::string> warnings;  // what had to be guessed, one line each
};

// The mesh of the file, z up and in metres. By its format's rule a glTF file is y up and is turned
// (x, y, z) -> (x, -z, y); others are taken as they are. Where the points (3 x points, m, at least
// one) fit the other way up only, or only in centimetres or millimetres, that is taken, and said.
// Points fit if they are on average nearer to the surface than 3 % of the diagonal of their box, or
// than half their spacing, and the mesh is less than 10 times as large; if they do not, those deep
// among others are left out. Throws Error as ReadMesh does, and if nothing fits.
PlacedMesh ReadMeshAt(const std::string& path, const Points& points);

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_MESH_PLACE_H_
