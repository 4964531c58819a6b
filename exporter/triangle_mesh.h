// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_EXPORTER_TRIANGLE_MESH_H_
#define PHYSPRING_EXPORTER_TRIANGLE_MESH_H_

#include <array>
#include <vector>

#include "twin/points.h"

namespace physpring {

struct TriangleMesh {
  Points vertices = Points(3, 0);         // 3 x vertices, m
  std::vector<std::array<int, 3>> faces;  // counter-clockwise from outside
};

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_TRIANGLE_MESH_H_
