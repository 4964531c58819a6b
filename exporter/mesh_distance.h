// SPDX-License-Identifier: Apache-2.0
// How far points are from the surface of a mesh.
#ifndef PHYSPRING_EXPORTER_MESH_DISTANCE_H_
#define PHYSPRING_EXPORTER_MESH_DISTANCE_H_

#include "exporter/triangle_mesh.h"
#include "twin/neighbours.h"

namespace physpring {

class MeshDistance {
 public:
  // The mesh must outlive it, and have a face.
  explicit MeshDistance(const TriangleMesh& mesh);

  // From `x` to the nearest place of a face, m.
  double At(const Eigen::Vector3d& x) const;
  // Their mean over columns of `points` (3 x points, at least one), m.
  double Mean(const Points& points) const;
  // Mean distance to the mesh's box, m: never more than Mean, and quick. Far from a mesh of many
  // faces Mean is slow, because all of them are about as near.
  double MeanToBox(const Points& points) const;

 private:
  const TriangleMesh& mesh_;
  NeighbourSearch centres_;     // of the faces
  double largest_radius_;       // m: no corner is farther from the centre of its face
  Eigen::Vector3d low_, high_;  // m, of the box
};

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_MESH_DISTANCE_H_
