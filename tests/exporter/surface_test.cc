// SPDX-License-Identifier: Apache-2.0
#include "exporter/surface.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>
#include <numbers>

#include "exporter/surface_nets.h"
#include "tests/support/random_system.h"

namespace physpring {
namespace {

// Whether each edge of a face is one of another face, the other way round.
bool IsClosed(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, int> edges;
  for (const std::array<int, 3>& face : mesh.faces) {
    for (int k = 0; k < 3; ++k) {
      const int a = face[k], b = face[(k + 1) % 3];
      ++edges[{a, b}];
      --edges[{b, a}];
    }
  }
  for (const auto& [edge, balance] : edges) {
    if (balance != 0) return false;
  }
  return !mesh.faces.empty();
}

// Positive if the faces are counter-clockwise from outside.
double Volume(const TriangleMesh& mesh) {
  double volume = 0;
  for (const auto& [a, b, c] : mesh.faces) {
    const Eigen::Vector3d x = mesh.vertices.col(a);
    volume += x.dot(mesh.vertices.col(b).cross(mesh.vertices.col(c))) / 6;
  }
  return volume;
}

Points Lattice(int x, int y, int z) {
  Points points(3, x * y * z);
  for (int i = 0; i < points.cols(); ++i) {
    points.col(i) = Eigen::Vector3i(i % x, i / x % y, i / (x * y)).cast<double>();
  }
  return points;
}

// A grid of the distance from the sphere of radius 1.
Grid Sphere() {
  Grid grid({-1.5, -1.5, -1.5}, 0.1, {31, 31, 31});
  for (int i = 0; i < grid.count(); ++i) grid.value(i) = grid.Position(i).norm() - 1;
  return grid;
}

TEST(SurfaceNets, FindsASphere) {
  const TriangleMesh mesh = SurfaceNets(Sphere());
  EXPECT_TRUE(IsClosed(mesh));
  // chords cut off some of it: less than the square of a cell
  EXPECT_NEAR(Volume(mesh), 4 * std::numbers::pi / 3, 0.06);
  for (const auto& vertex : mesh.vertices.colwise()) EXPECT_NEAR(vertex.norm(), 1, 0.01);
}

TEST(SurfaceNets, CavitiesAreFilled) {
  Grid grid = Sphere();
  for (int i = 0; i < grid.count(); ++i) {
    grid.value(i) = std::max(grid.value(i), 0.5 - grid.Position(i).norm());
  }
  const double hollow = Volume(SurfaceNets(grid));
  FillCavities(&grid);
  EXPECT_NEAR(Volume(SurfaceNets(grid)), Volume(SurfaceNets(Sphere())), 1e-12);
  EXPECT_LT(hollow, 0.95 * Volume(SurfaceNets(grid)));
}

TEST(Surface, SpacingIsThatOfTheLattice) {
  EXPECT_NEAR(Spacing(0.3 * Lattice(4, 3, 2)), 0.3, 1e-12);
}

TEST(Surface, TellsSheetsFromSolidsAndRods) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  Random random(2);
  const Points sheet = turn.matrix() * Lattice(9, 7, 1);
  EXPECT_TRUE(IsSheet(sheet + random.Box(63, 0.2)));
  EXPECT_FALSE(IsSheet(Lattice(9, 7, 2)));
  EXPECT_FALSE(IsSheet(turn.matrix() * Lattice(9, 1, 1)));
  EXPECT_FALSE(IsSheet(Lattice(20, 2, 2)));
}

TEST(Surface, OfASheetHasTwoSidesAndSparesGaps) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  Points two(3, 40);
  two << Lattice(5, 4, 1), Lattice(5, 4, 1).colwise() + Eigen::Vector3d(20, 0, 0);
  const TriangleMesh mesh = SheetSurface(turn.matrix() * two);
  EXPECT_EQ(mesh.vertices.cols(), 80);
  EXPECT_EQ(mesh.faces.size(), 2u * 2 * 2 * 4 * 3);
  EXPECT_NEAR(Volume(mesh), 0, 1e-9);  // each face is there both ways round
}

TEST(Surface, OfASolidIsClosedAndNearItsPoints) {
  const TriangleMesh mesh = ClosedSurface(Lattice(6, 5, 4), 0.5);
  EXPECT_TRUE(IsClosed(mesh));
  // about through the outermost points, which are 5, 4 and 3 apart
  EXPECT_GT(Volume(mesh), 5 * 4 * 3);
  EXPECT_LT(Volume(mesh), 6 * 5 * 4);
  EXPECT_GT(mesh.vertices.minCoeff(), -0.5);
}

TEST(Surface, OfAHollowShellHasNoInside) {
  Points shell(3, 400);  // Fibonacci's spiral on the sphere of radius 1
  for (int i = 0; i < 400; ++i) {
    const double z = (2 * i + 1) / 400.0 - 1, angle = i * std::numbers::pi * (3 - std::sqrt(5));
    shell.col(i) << std::sqrt(1 - z * z) * Eigen::Vector2d(std::cos(angle), std::sin(angle)), z;
  }
  const TriangleMesh mesh = ClosedSurface(shell, 0.1);
  EXPECT_TRUE(IsClosed(mesh));
  // between that of the spheres of radius 0.9 and 1.1, not the volume between them
  EXPECT_GT(Volume(mesh), 4 * std::numbers::pi / 3 * std::pow(0.9, 3));
}

}  // namespace
}  // namespace physpring
