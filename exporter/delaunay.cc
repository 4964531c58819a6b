// SPDX-License-Identifier: Apache-2.0
#include "exporter/delaunay.h"

#include <Eigen/LU>
#include <algorithm>
#include <set>

namespace physpring {
namespace {

using Triangle = std::array<int, 3>;
using Edge = std::array<int, 2>;

constexpr double kFar = 1e3;  // how far corners are around all points, in sizes of their box

double Orientation(const Eigen::Matrix2Xd& p, const Triangle& t) {
  const Eigen::Vector2d u = p.col(t[1]) - p.col(t[0]), v = p.col(t[2]) - p.col(t[0]);
  return u[0] * v[1] - u[1] * v[0];
}

// Whether point i is within the circle through a counter-clockwise triangle.
bool CircleHolds(const Eigen::Matrix2Xd& p, const Triangle& t, int i) {
  Eigen::Matrix3d rows;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector2d d = p.col(t[k]) - p.col(i);
    rows.row(k) << d[0], d[1], d.squaredNorm();
  }
  return rows.determinant() > 0;
}

// The points, in a box of size 1, and three corners far around them.
Eigen::Matrix2Xd WithCorners(const Eigen::Matrix2Xd& points) {
  const Eigen::Vector2d low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
  const double size = std::max((high - low).maxCoeff(), 1e-300);
  Eigen::Matrix2Xd p(2, points.cols() + 3);
  p.leftCols(points.cols()) = (points.colwise() - (low + high) / 2) / size;
  p.rightCols(3) << -kFar, kFar, 0, -kFar, -kFar, kFar;
  return p;
}

void Insert(const Eigen::Matrix2Xd& p, int i, std::vector<Triangle>* triangles) {
  std::set<Edge> outline;
  std::erase_if(*triangles, [&](const Triangle& t) {
    if (!CircleHolds(p, t, i)) return false;
    for (int k = 0; k < 3; ++k) {
      const Edge edge{t[k], t[(k + 1) % 3]};
      // an edge between two such triangles is within the outline
      if (outline.erase({edge[1], edge[0]}) == 0) outline.insert(edge);
    }
    return true;
  });
  for (const auto& [a, b] : outline) triangles->push_back({a, b, i});
}

}  // namespace

std::vector<Triangle> Delaunay(const Eigen::Matrix2Xd& points) {
  const int count = static_cast<int>(points.cols());
  if (count < 3) return {};
  const Eigen::Matrix2Xd p = WithCorners(points);
  std::vector<Triangle> triangles{{count, count + 1, count + 2}};
  for (int i = 0; i < count; ++i) Insert(p, i, &triangles);
  std::erase_if(triangles, [&](const Triangle& t) {
    return *std::max_element(t.begin(), t.end()) >= count || Orientation(p, t) < 1e-12;
  });
  return triangles;
}

}  // namespace physpring
