// SPDX-License-Identifier: Apache-2.0
#include "exporter/mesh_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "exporter/surface_nets.h"
#include "tests/support/random_system.h"

namespace physpring {
namespace {

// A triangle in the plane z = 0 with corners at 0, (1, 0) and (0, 1).
TriangleMesh Triangle() {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 3);
  mesh.vertices << 0, 1, 0, 0, 0, 1, 0, 0, 0;
  mesh.faces = {{0, 1, 2}};
  return mesh;
}

TEST(MeshDistance, IsToTheFaceTheEdgeOrTheCornerThatIsNearest) {
  const TriangleMesh triangle = Triangle();
  const MeshDistance mesh(triangle);
  EXPECT_NEAR(mesh.At({0.2, 0.3, 0.7}), 0.7, 1e-15);       // above the face
  EXPECT_NEAR(mesh.At({0.2, 0.3, -0.7}), 0.7, 1e-15);      // below
  EXPECT_NEAR(mesh.At({0.5, -3, 4}), 5, 1e-14);            // beside an edge
  EXPECT_NEAR(mesh.At({1, 1, 0}), std::sqrt(0.5), 1e-15);  // beside the long one
  EXPECT_NEAR(mesh.At({3, -2, 1}), 3, 1e-14);              // beyond a corner
  EXPECT_NEAR(mesh.Mean(Points{{0.2, 0.2}, {0.3, 0.3}, {1, 3}}), 2, 1e-14);
}

TEST(MeshDistance, IsToTheNearestOfManyFacesOfAllSizes) {
  Grid grid({-1.5, -1.5, -1.5}, 0.1, {31, 31, 31});
  for (int i = 0; i < grid.count(); ++i) grid.value(i) = grid.Position(i).norm() - 1;
  TriangleMesh mesh = SurfaceNets(grid);
  // and a large face far from its centre's neighbours: z = 1.2 below y = x
  const int first = static_cast<int>(mesh.vertices.cols());
  mesh.vertices.conservativeResize(3, first + 3);
  mesh.vertices.rightCols(3) << -9, 9, 9, -9, -9, 9, 1.2, 1.2, 1.2;
  mesh.faces.push_back({first, first + 1, first + 2});
  const MeshDistance distance(mesh);
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d x = random.Box(1, 2);
    const double to_plane = std::hypot(x[2] - 1.2, std::max(0.0, (x[1] - x[0]) / std::sqrt(2)));
    const double expected = std::min(std::abs(x.norm() - 1), to_plane);
    EXPECT_NEAR(distance.At(x), expected, 0.01) << x.transpose();  // cell^2 / radius
  }
}

TEST(MeshDistance, ToTheBoxIsNeverMore) {
  const TriangleMesh triangle = Triangle();
  const MeshDistance mesh(triangle);
  EXPECT_NEAR(mesh.MeanToBox(Eigen::Vector3d(0.9, 0.9, -2)), 2, 1e-15);
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Points points = random.Box(3, 2);
    EXPECT_LE(mesh.MeanToBox(points), mesh.Mean(points) + 1e-15);
  }
}

TEST(MeshDistance, FacesWithoutAreaAreEdges) {
  TriangleMesh mesh = Triangle();
  mesh.faces = {{0, 1, 1}, {2, 2, 2}};
  EXPECT_NEAR(MeshDistance(mesh).At({0.5, 0.2, 0}), 0.2, 1e-15);
  EXPECT_NEAR(MeshDistance(mesh).At({0, 2, 0}), 1, 1e-15);
}

}  // namespace
}  // namespace physpring
