// SPDX-License-Identifier: Apache-2.0
// What an exported object looks like: a skin (a mesh bound to the nodes), or, for rods, a tendon
// without force from node to node, because nodes do not turn and so cannot carry the skin of a
// tube.
#ifndef PHYSPRING_EXPORTER_PICTURE_H_
#define PHYSPRING_EXPORTER_PICTURE_H_

#include <string>
#include <vector>

#include "exporter/level_plan.h"
#include "exporter/triangle_mesh.h"
#include "exporter/xml.h"

namespace physpring {

struct Picture {
  bool rod = false;
  double radius = 0;                  // m, of a rod; or by how much a skin is inflated
  TriangleMesh mesh;                  // the skin's, in the reference configuration; empty for a rod
  std::vector<std::string> warnings;  // what of a mesh file had to be guessed
};

// The picture of `mesh_file`, if it is not empty; else one made from level 0: a rod where the twin
// has an order along one, a sheet where the points are in one layer, else a closed surface. Throws
// Error as ReadMeshAt does: the points of the twin must be on the mesh.
Picture MakePicture(const Twin& twin, const std::string& mesh_file);

void AddPicture(const LevelPlan& plan, const Picture& picture, XmlElement* mujoco);

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_PICTURE_H_
