// SPDX-License-Identifier: Apache-2.0
#include "exporter/mesh_interior.h"

#include <gtest/gtest.h>

#include <numbers>

#include "exporter/surface_nets.h"
#include "twin/error.h"

namespace physpring {
namespace {

// The sphere of radius 1.
TriangleMesh Sphere() {
  Grid grid({-1.5, -1.5, -1.5}, 0.2, {16, 16, 16});
  for (int i = 0; i < grid.count(); ++i) grid.value(i) = grid.Position(i).norm() - 1;
  return SurfaceNets(grid);
}

const Points kNone = Points(3, 0);

TEST(MeshInterior, WindingNumberTellsInsideFromOutside) {
  TriangleMesh mesh = Sphere();
  EXPECT_NEAR(WindingNumber(mesh, {0.3, -0.5, 0.6}), 1, 1e-9);
  EXPECT_NEAR(WindingNumber(mesh, {0.3, -0.5, 0.9}), 0, 1e-9);
  for (std::array<int, 3>& face : mesh.faces) std::swap(face[0], face[1]);
  EXPECT_NEAR(WindingNumber(mesh, {0, 0, 0}), -1, 1e-9);
}

TEST(MeshInterior, PointsFillTheMesh) {
  const TriangleMesh mesh = Sphere();
  const Points points = SampleInterior(mesh, 0.1, kNone);
  // the ball without a layer of half a spacing at the vertices
  const double volume = 4 * std::numbers::pi / 3 / 1e-3;
  EXPECT_GT(static_cast<double>(points.cols()), 0.8 * volume);
  EXPECT_LT(static_cast<double>(points.cols()), volume);
  EXPECT_LT(points.colwise().norm().maxCoeff(), 1);
  EXPECT_LT(points.rowwise().mean().norm(), 0.01);
}

TEST(MeshInterior, AHoleDoesNotMatter) {
  TriangleMesh mesh = Sphere();
  const Eigen::Index before = SampleInterior(mesh, 0.2, kNone).cols();
  mesh.faces.resize(mesh.faces.size() - 8);
  EXPECT_NEAR(static_cast<double>(SampleInterior(mesh, 0.2, kNone).cols()),
              static_cast<double>(before), 4);
}

TEST(MeshInterior, PointsKeepAwayFromThoseThere) {
  const Points taken = Eigen::Vector3d(0.01, 0.02, 0.03);
  const Points points = SampleInterior(Sphere(), 0.2, taken);
  EXPECT_GE((points.colwise() - taken.col(0)).colwise().norm().minCoeff(), 0.1);
}

TEST(MeshInterior, TooManyPointsAreRefused) {
  EXPECT_THROW(SampleInterior(Sphere(), 1e-3, kNone), Error);
}

}  // namespace
}  // namespace physpring
