// SPDX-License-Identifier: Apache-2.0
// Meshes from files: OBJ, PLY, STL, GLB and whatever else assimp reads.
#ifndef PHYSPRING_EXPORTER_MESH_FILE_H_
#define PHYSPRING_EXPORTER_MESH_FILE_H_

#include <string>

#include "exporter/triangle_mesh.h"

namespace physpring {

// All triangles of the file in its own coordinates, equal vertices joined. Throws Error, beginning
// with the path, if the file is not readable as a mesh, has no triangles, more than 200,000
// vertices, or a vertex that is not finite.
TriangleMesh ReadMesh(const std::string& path);

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_MESH_FILE_H_
