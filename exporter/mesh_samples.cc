// SPDX-License-Identifier: Apache-2.0
#include "exporter/mesh_samples.h"

#include <algorithm>
#include <random>
#include <vector>

#include "twin/error.h"
#include "twin/uniform.h"

namespace physpring {

Points SampleSurface(const TriangleMesh& mesh, int count) {
  std::vector<double> area_until;  // of the faces up to each one, m^2
  double area = 0;
  for (const auto& [a, b, c] : mesh.faces) {
    const Eigen::Vector3d corner = mesh.vertices.col(a);
    area += (mesh.vertices.col(b) - corner).cross(mesh.vertices.col(c) - corner).norm() / 2;
    area_until.push_back(area);
  }
  if (!(area > 0)) throw Error("the mesh: its faces have no area");
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

}  // namespace physpring
