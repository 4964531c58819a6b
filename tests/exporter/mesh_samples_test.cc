// SPDX-License-Identifier: Apache-2.0
#include "exporter/mesh_samples.h"

#include <gtest/gtest.h>

#include "exporter/mesh_distance.h"
#include "tests/support/file_damage.h"

namespace physpring {
namespace {

// A square of side 1 in two faces, and beside it one of a quarter of its area, 1 higher.
TriangleMesh Squares() {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 8);
  mesh.vertices << 0, 1, 1, 0, 2, 2.5, 2.5, 2,  //
      0, 0, 1, 1, 0, 0, 0.5, 0.5,               //
      0, 0, 0, 0, 1, 1, 1, 1;
  mesh.faces = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  return mesh;
}

TEST(MeshSamples, LieOnTheFacesInProportionToTheirArea) {
  const TriangleMesh mesh = Squares();
  const Points points = SampleSurface(mesh, 5000);
  EXPECT_LT(MeshDistance(mesh).Mean(points), 1e-12);
  EXPECT_NEAR(points.row(2).sum(), 1000, 2);  // those on the higher one
  const Points large = points.leftCols(4000);
  EXPECT_NEAR(large.row(0).mean(), 0.5, 0.02);
  EXPECT_NEAR(large.row(1).mean(), 0.5, 0.02);
  // each quarter of the large one has its share
  const auto low = (large.row(0).array() < 0.5) && (large.row(1).array() < 0.5);
  EXPECT_NEAR(static_cast<double>(low.count()), 1000, 100);
}

TEST(MeshSamples, AreTheSameEachTime) {
  EXPECT_EQ(SampleSurface(Squares(), 50), SampleSurface(Squares(), 50));
}

// The large square has points 0.1 apart, the small one none.
TEST(MeshSamples, AreAddedWhereNoneAre) {
  Points taken(3, 121);
  for (int i = 0; i < 121; ++i) taken.col(i) << 0.1 * (i % 11), 0.1 * (i / 11), 0;
  const Points bare = SampleBare(Squares(), 0.12, taken);
  EXPECT_GT(bare.cols(), 12);
  EXPECT_LT(bare.cols(), 40);
  EXPECT_TRUE((bare.row(2).array() == 1).all());
  for (int i = 0; i < bare.cols(); ++i) {
    for (int j = 0; j < i; ++j) EXPECT_GT((bare.col(i) - bare.col(j)).norm(), 0.12);
  }
  EXPECT_EQ(SampleBare(Squares(), 0.12, taken), bare);
  EXPECT_EQ(ErrorOf("the mesh", [&] { SampleBare(Squares(), 1e-3, taken); }),
            "the mesh: its surface has room for 1.2e+06 points 0.001 m apart, more than 1e+04");
}

TEST(MeshSamples, NeedAnArea) {
  TriangleMesh mesh = Squares();
  mesh.vertices.colwise() = Eigen::Vector3d(1, 2, 3);
  EXPECT_EQ(ErrorOf("the mesh", [&] { SampleSurface(mesh, 5); }),
            "the mesh: its faces have no area");
}

}  // namespace
}  // namespace physpring
