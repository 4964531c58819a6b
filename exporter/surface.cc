// SPDX-License-Identifier: Apache-2.0
#include "exporter/surface.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "exporter/delaunay.h"
#include "exporter/surface_nets.h"
#include "twin/neighbours.h"

namespace physpring {
namespace {

constexpr double kLongestEdge = 4;     // spacings
constexpr double kKernelRadius = 2.5;  // spacings
constexpr double kCell = 0.7;          // spacings
constexpr int kMostCells = 2000000;

// Axes of the points' extent, as columns: the first across the plane they are nearest to.
Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> PrincipalAxes(const Points& points) {
  const Points centred = points.colwise() - points.rowwise().mean();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(centred * centred.transpose() /
                                                        static_cast<double>(points.cols()));
}

// The function whose zero is the surface, at x.
double Distance(const Points& points, const NeighbourSearch& search, const Eigen::Vector3d& x,
                double reach, double radius) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weights = 0;
  for (const Neighbour& near : search.Within(x, reach)) {
    const double s = near.distance / reach;
    const double weight = std::pow(1 - s * s, 3);
    sum += weight * points.col(near.index);
    weights += weight;
  }
  return weights > 0 ? (x - sum / weights).norm() - radius : reach;
}

}  // namespace

double Spacing(const Points& points) {
  const NeighbourSearch search(points);
  double sum = 0;
  for (const auto& point : points.colwise()) sum += search.Nearest(point, 2)[1].distance;
  return sum / static_cast<double>(points.cols());
}

bool IsSheet(const Points& points) {
  if (points.cols() < 4) return false;
  const Eigen::Vector3d variance = PrincipalAxes(points).eigenvalues();
  const double spacing = Spacing(points);
  return std::sqrt(std::max(variance[0], 0.0)) < 0.5 * spacing && std::sqrt(variance[1]) > spacing;
}

TriangleMesh SheetSurface(const Points& points) {
  const Eigen::Matrix3d axes = PrincipalAxes(points).eigenvectors();
  const double longest = kLongestEdge * Spacing(points);
  const Eigen::Index count = points.cols();
  TriangleMesh mesh;
  mesh.vertices.resize(3, 2 * count);
  mesh.vertices << points, points;
  for (const auto& [a, b, c] : Delaunay(axes.rightCols(2).transpose() * points)) {
    const auto length = [&](int i, int j) { return (points.col(i) - points.col(j)).norm(); };
    if (std::max({length(a, b), length(b, c), length(c, a)}) > longest) continue;
    const int back = static_cast<int>(count);
    mesh.faces.push_back({a, b, c});
    mesh.faces.push_back({back + a, back + c, back + b});
  }
  return mesh;
}

TriangleMesh ClosedSurface(const Points& points, double radius) {
  const double spacing = Spacing(points);
  const double reach = std::max(kKernelRadius * spacing, 1.5 * radius);
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(radius + 2 * kCell * spacing);
  const Eigen::Vector3d low = points.rowwise().minCoeff() - margin;
  const Eigen::Vector3d size = points.rowwise().maxCoeff() + margin - low;
  const double cell = std::max(kCell * spacing, std::cbrt(size.prod() / kMostCells));
  Grid grid(low, cell, (size / cell).array().ceil().cast<int>() + 1);
  const NeighbourSearch search(points);
  for (int i = 0; i < grid.count(); ++i) {
    grid.value(i) = Distance(points, search, grid.Position(i), reach, radius);
  }
  FillCavities(&grid);
  return SurfaceNets(grid);
}

}  // namespace physpring
