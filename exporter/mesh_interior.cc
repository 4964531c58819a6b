// SPDX-License-Identifier: Apache-2.0
#include "exporter/mesh_interior.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "twin/error.h"
#include "twin/neighbours.h"

namespace physpring {
namespace {

constexpr double kMostPoints = 1e6;

// Solid angle of the triangle a, b, c seen from the origin (Van Oosterom and Strackee, 1983).
double SolidAngle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  const double below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  return 2 * std::atan2(a.dot(b.cross(c)), below);
}

}  // namespace

double WindingNumber(const TriangleMesh& mesh, const Eigen::Vector3d& x) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.faces) {
    sum += SolidAngle(mesh.vertices.col(a) - x, mesh.vertices.col(b) - x, mesh.vertices.col(c) - x);
  }
  return sum / (4 * std::numbers::pi);
}

Points SampleInterior(const TriangleMesh& mesh, double spacing, const Points& taken) {
  const Eigen::Vector3d low = mesh.vertices.rowwise().minCoeff();
  const Eigen::Vector3d high = mesh.vertices.rowwise().maxCoeff();
  const Eigen::Array3d counts = ((high - low).array() / spacing).floor() + 1;
  if (counts.prod() > kMostPoints) {
    throw Error(fmt::format("spacing {} m: gives {:.2g} points in the mesh's box, more than {:.2g}",
                            spacing, counts.prod(), kMostPoints));
  }
  // centred in the box
  const Eigen::Vector3d first = (low + high - spacing * (counts - 1).matrix()) / 2;
  Points occupied(3, mesh.vertices.cols() + taken.cols());
  occupied << mesh.vertices, taken;
  const NeighbourSearch search(occupied);
  std::vector<Eigen::Vector3d> inside;
  const Eigen::Array3i n = counts.cast<int>();
  for (int i = 0; i < n.prod(); ++i) {
    const Eigen::Vector3i place(i % n[0], i / n[0] % n[1], i / (n[0] * n[1]));
    const Eigen::Vector3d x = first + spacing * place.cast<double>();
    if (search.Nearest(x, 1)[0].distance < spacing / 2) continue;
    if (std::abs(WindingNumber(mesh, x)) > 0.5) inside.push_back(x);
  }
  Points points(3, static_cast<Eigen::Index>(inside.size()));
  for (std::size_t i = 0; i < inside.size(); ++i)
    points.col(static_cast<Eigen::Index>(i)) = inside[i];
  return points;
}

}  // namespace physpring
