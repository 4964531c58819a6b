// SPDX-License-Identifier: Apache-2.0
#include "exporter/surface_nets.h"

#include <cmath>

namespace physpring {
namespace {

// Whether the corner is the lowest of a cell.
bool StartsCell(const Grid& grid, int corner) {
  return ((grid.Place(corner).array() + 1) < grid.counts().array()).all();
}

// The mean of the zeros on the cell's edges, or none (false).
bool CellVertex(const Grid& grid, int cell, Eigen::Vector3d* vertex) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int zeros = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = grid.stride((axis + 1) % 3), v = grid.stride((axis + 2) % 3);
    for (const int start : {cell, cell + u, cell + v, cell + u + v}) {
      const int end = start + grid.stride(axis);
      const double from = grid.value(start), to = grid.value(end);
      if ((from < 0) == (to < 0)) continue;
      const double share = from / (from - to);
      sum += (1 - share) * grid.Position(start) + share * grid.Position(end);
      ++zeros;
    }
  }
  if (zeros > 0) *vertex = sum / zeros;
  return zeros > 0;
}

}  // namespace

void FillCavities(Grid* grid) {
  std::vector<bool> outside(static_cast<std::size_t>(grid->count()));
  std::vector<int> open{0};
  outside[0] = true;
  while (!open.empty()) {
    const int corner = open.back();
    open.pop_back();
    for (int axis = 0; axis < 3; ++axis) {
      const int place = grid->Place(corner)[axis];
      for (const int side : {-1, 1}) {
        if (place + side < 0 || place + side >= grid->counts()[axis]) continue;
        const int next = corner + side * grid->stride(axis);
        if (outside[next] || grid->value(next) < 0) continue;
        outside[next] = true;
        open.push_back(next);
      }
    }
  }
  for (int i = 0; i < grid->count(); ++i) {
    if (!outside[i]) grid->value(i) = -std::abs(grid->value(i)) - 1e-300;
  }
}

TriangleMesh SurfaceNets(const Grid& grid) {
  std::vector<int> vertex_of(static_cast<std::size_t>(grid.count()), -1);
  std::vector<Eigen::Vector3d> vertices;
  for (int i = 0; i < grid.count(); ++i) {
    Eigen::Vector3d vertex;
    if (!StartsCell(grid, i) || !CellVertex(grid, i, &vertex)) continue;
    vertex_of[i] = static_cast<int>(vertices.size());
    vertices.push_back(vertex);
  }
  TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(vertices.size()));
  for (std::size_t i = 0; i < vertices.size(); ++i) mesh.vertices.col(i) = vertices[i];
  for (int i = 0; i < grid.count(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      if (grid.Place(i)[axis] + 1 >= grid.counts()[axis]) continue;
      const bool inside = grid.value(i) < 0;
      if (inside == (grid.value(i + grid.stride(axis)) < 0)) continue;
      const int u = grid.stride((axis + 1) % 3), v = grid.stride((axis + 2) % 3);
      // around the edge counter-clockwise, seen from its end
      const int a = vertex_of[i - u - v], b = vertex_of[i - v], c = vertex_of[i],
                d = vertex_of[i - u];
      if (inside) {
        mesh.faces.insert(mesh.faces.end(), {{a, b, c}, {a, c, d}});
      } else {
        mesh.faces.insert(mesh.faces.end(), {{a, c, b}, {a, d, c}});
      }
    }
  }
  return mesh;
}

}  // namespace physpring
