// SPDX-License-Identifier: Apache-2.0
#include "exporter/mesh_distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace physpring {
namespace {

Points Centres(const TriangleMesh& mesh) {
  Points centres(3, static_cast<Eigen::Index>(mesh.faces.size()));
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    const auto& [a, b, c] = mesh.faces[i];
    centres.col(static_cast<Eigen::Index>(i)) =
        (mesh.vertices.col(a) + mesh.vertices.col(b) + mesh.vertices.col(c)) / 3;
  }
  return centres;
}

double LargestRadius(const TriangleMesh& mesh) {
  const Points centres = Centres(mesh);
  double largest = 0;
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    const Eigen::Vector3d centre = centres.col(static_cast<Eigen::Index>(i));
    for (const int corner : mesh.faces[i]) {
      largest = std::max(largest, (mesh.vertices.col(corner) - centre).norm());
    }
  }
  return largest;
}

double ToEdge(const Eigen::Vector3d& x, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d along = to - from;
  const double squared = along.squaredNorm();
  const double share = squared > 0 ? std::clamp((x - from).dot(along) / squared, 0.0, 1.0) : 0;
  return (x - from - share * along).norm();
}

// The foot of the perpendicular, where it is inside all three edges; else the nearest edge.
double ToTriangle(const Eigen::Vector3d& x, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                  const Eigen::Vector3d& c) {
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const auto inside = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    return normal.dot((to - from).cross(x - from)) >= 0;
  };
  if (normal.squaredNorm() > 0 && inside(a, b) && inside(b, c) && inside(c, a)) {
    return std::abs(normal.normalized().dot(x - a));
  }
  return std::min({ToEdge(x, a, b), ToEdge(x, b, c), ToEdge(x, c, a)});
}

}  // namespace

MeshDistance::MeshDistance(const TriangleMesh& mesh)
    : mesh_(mesh),
      centres_(Centres(mesh)),
      largest_radius_(LargestRadius(mesh)),
      low_(mesh.vertices.rowwise().minCoeff()),
      high_(mesh.vertices.rowwise().maxCoeff()) {}

// Faces in the order of their centres: one whose centre is farther than the best distance and the
// largest radius together is farther, and so are all that follow.
double MeshDistance::At(const Eigen::Vector3d& x) const {
  const int faces = static_cast<int>(mesh_.faces.size());
  double best = std::numeric_limits<double>::infinity();
  int seen = 0;
  for (int count = 16; seen < faces; count *= 4) {
    const std::vector<Neighbour> nearest = centres_.Nearest(x, std::min(count, faces));
    for (; seen < static_cast<int>(nearest.size()); ++seen) {
      if (nearest[seen].distance > best + largest_radius_) return best;
      const auto& [a, b, c] = mesh_.faces[nearest[seen].index];
      best = std::min(
          best, ToTriangle(x, mesh_.vertices.col(a), mesh_.vertices.col(b), mesh_.vertices.col(c)));
    }
  }
  return best;
}

double MeshDistance::MeanToBox(const Points& points) const {
  double sum = 0;
  for (const auto& x : points.colwise()) sum += (x - x.cwiseMax(low_).cwiseMin(high_)).norm();
  return sum / static_cast<double>(points.cols());
}

double MeshDistance::Mean(const Points& points) const {
  double sum = 0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) sum += At(points.col(i));
  return sum / static_cast<double>(points.cols());
}

}  // namespace physpring
