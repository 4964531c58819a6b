// SPDX-License-Identifier: Apache-2.0
#include "exporter/delaunay.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/support/random_system.h"

namespace physpring {
namespace {

double Area(const Eigen::Matrix2Xd& p, const std::array<int, 3>& t) {
  const Eigen::Vector2d u = p.col(t[1]) - p.col(t[0]), v = p.col(t[2]) - p.col(t[0]);
  return (u[0] * v[1] - u[1] * v[0]) / 2;
}

double SumOfAreas(const Eigen::Matrix2Xd& points) {
  double sum = 0;
  for (const auto& triangle : Delaunay(points)) {
    EXPECT_GT(Area(points, triangle), 0);  // counter-clockwise
    sum += Area(points, triangle);
  }
  return sum;
}

Eigen::Matrix2Xd Lattice(int columns, int rows) {
  Eigen::Matrix2Xd points(2, columns * rows);
  for (int i = 0; i < points.cols(); ++i) {
    points.col(i) = Eigen::Vector2i(i % columns, i / columns).cast<double>();
  }
  return points;
}

TEST(Delaunay, FillsALattice) {
  EXPECT_NEAR(SumOfAreas(Lattice(7, 5)), 6 * 4, 1e-9);
  EXPECT_EQ(Delaunay(Lattice(7, 5)).size(), 2u * 6 * 4);
}

TEST(Delaunay, HasNoPointInsideACircle) {
  Random random(5);
  const Eigen::Matrix2Xd points = random.Box(80, 1).topRows(2);
  const auto triangles = Delaunay(points);
  EXPECT_GT(triangles.size(), 100u);
  for (const auto& [a, b, c] : triangles) {
    // the circle's centre is as far from a as from b and from c
    Eigen::Matrix2d rows;
    rows << (points.col(b) - points.col(a)).transpose(),
        (points.col(c) - points.col(a)).transpose();
    const Eigen::Vector2d squares(points.col(b).squaredNorm() - points.col(a).squaredNorm(),
                                  points.col(c).squaredNorm() - points.col(a).squaredNorm());
    const Eigen::Vector2d centre = rows.inverse() * squares / 2;
    const double radius = (points.col(a) - centre).norm();
    for (const auto& point : points.colwise()) {
      EXPECT_GT((point - centre).norm(), radius * (1 - 1e-9));
    }
  }
}

TEST(Delaunay, DoesNotMindPointsThatCoincide) {
  Eigen::Matrix2Xd points(2, 8);
  points << Lattice(2, 2), Lattice(2, 2);
  EXPECT_NEAR(SumOfAreas(points), 1, 1e-9);
}

TEST(Delaunay, IsEmptyOnALine) {
  EXPECT_TRUE(Delaunay(Lattice(5, 1)).empty());
  EXPECT_TRUE(Delaunay(Lattice(2, 1)).empty());
  EXPECT_TRUE(Delaunay(Eigen::Matrix2Xd(2, 0)).empty());
}

}  // namespace
}  // namespace physpring
