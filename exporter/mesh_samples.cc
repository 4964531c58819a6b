// SPDX-License-Identifier: Apache-2.0
#include "exporter/mesh_samples.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "twin/error.h"
#include "twin/neighbours.h"
#include "twin/uniform.h"

namespace physpring {

namespace {

constexpr double kMostBare = 1e4;

// Of the faces up to each one, m^2.
std::vector<double> AreasUntil(const TriangleMesh& mesh) {
  std::vector<double> area_until;
  double area = 0;
  for (const auto& [a, b, c] : mesh.faces) {
    const Eigen::Vector3d corner = mesh.vertices.col(a);
    area += (mesh.vertices.col(b) - corner).cross(mesh.vertices.col(c) - corner).norm() / 2;
    area_until.push_back(area);
  }
  if (!(area > 0)) throw Error("the mesh: its faces have no area");
  return area_until;
}

}  // namespace

Points SampleSurface(const TriangleMesh& mesh, int count) {
  const std::vector<double> area_until = AreasUntil(mesh);
  const double area = area_until.back();
  std::mt19937_64 random(0);
  Points points(3, count);
  for (int i = 0; i < count; ++i) {
    const auto face =
        std::upper_bound(area_until.begin(), area_until.end() - 1, (i + 0.5) / count * area);
    const auto& [a, b, c] = mesh.faces[static_cast<std::size_t>(face - area_until.begin())];
    double u = Uniform(&random), v = Uniform(&random);
    if (u + v > 1) {  // in the other half of the parallelogram
      u = 1 - u;
      v = 1 - v;
    }
    points.col(i) =
        (1 - u - v) * mesh.vertices.col(a) + u * mesh.vertices.col(b) + v * mesh.vertices.col(c);
  }
  return points;
}

Points SampleBare(const TriangleMesh& mesh, double spacing, const Points& taken) {
  constexpr double kSamples = 16;  // of a square of the spacing
  const double squares = AreasUntil(mesh).back() / (spacing * spacing);
  if (squares > kMostBare) {
    throw Error(
        fmt::format("the mesh: its surface has room for {:.2g} points {:.3g} m apart, more "
                    "than {:.2g}",
                    squares, spacing, kMostBare));
  }
  const Points samples = SampleSurface(mesh, static_cast<int>(std::ceil(kSamples * (1 + squares))));
  const NeighbourSearch search(taken);
  Eigen::RowVectorXd distance(samples.cols());  // to what is there, squared
  for (Eigen::Index i = 0; i < samples.cols(); ++i) {
    const double nearest = search.Nearest(samples.col(i), 1)[0].distance;
    distance[i] = nearest * nearest;
  }
  std::vector<Eigen::Vector3d> bare;
  for (Eigen::Index next; distance.maxCoeff(&next) > spacing * spacing;) {
    bare.emplace_back(samples.col(next));
    distance = distance.cwiseMin((samples.colwise() - bare.back()).colwise().squaredNorm());
  }
  Points points(3, static_cast<Eigen::Index>(bare.size()));
  for (std::size_t i = 0; i < bare.size(); ++i) points.col(static_cast<Eigen::Index>(i)) = bare[i];
  return points;
}

}  // namespace physpring
