// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/particle_mass.h"

#include <gtest/gtest.h>

#include "tests/support/swung_rope.h"

namespace physpring {
namespace {

// A grid of nx x ny x nz particles, 10 mm apart, the first index fastest.
Points Grid(int nx, int ny, int nz) {
  Points grid(3, nx * ny * nz);
  for (int i = 0; i < grid.cols(); ++i) {
    grid.col(i) = 0.01 * Eigen::Vector3i(i % nx, i / nx % ny, i / (nx * ny)).cast<double>();
  }
  return grid;
}

Recording SolidBox() {
  const Points grid = Grid(5, 4, 3);
  Recording box = SwungRope(4, 2);
  box.points.assign(2, grid.leftCols(20));
  box.interior = grid.rightCols(grid.cols() - 20);
  box.rest.resize(3, grid.cols() + box.controller_count());
  box.rest << grid, box.start.rightCols(box.controller_count());
  box.start = box.rest;
  box.rod = {};
  box.mass = 0.3;
  return box;
}

TEST(CellVolumes, OfABoxAreCellsHalvesQuartersAndEighths) {
  const Eigen::VectorXd volumes = CellVolumes(Grid(5, 5, 5)) * 1e6;
  EXPECT_NEAR(volumes.sum(), 4 * 4 * 4, 0.1 * 64);
  EXPECT_NEAR(volumes[2 + 5 * (2 + 5 * 2)], 1, 0.1);  // inside
  EXPECT_NEAR(volumes[2 + 5 * 2], 0.5, 0.1);          // on a face
  EXPECT_NEAR(volumes[2], 0.25, 0.05);                // on an edge
  EXPECT_NEAR(volumes[0], 0.125, 0.025);              // at a corner
}

TEST(CellVolumes, DoNotDependOnWhereThePlaceIs) {
  const Points grid = Grid(4, 3, 3);
  const Points moved = grid.colwise() + Eigen::Vector3d(0.3, -0.1, 0.2);
  EXPECT_LT((CellVolumes(moved) - CellVolumes(grid)).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(CellVolumes, OfASheetAreNothing) { EXPECT_LT(CellVolumes(Grid(6, 6, 1)).sum(), 1e-6); }

TEST(ParticleMasses, OfASolidGoByVolumeDownToAFifthOfTheMean) {
  const Recording box = SolidBox();
  const Eigen::VectorXd masses = ParticleMasses(box);
  EXPECT_NEAR(masses.sum(), 0.3, 1e-15);
  EXPECT_NEAR(masses[26] / masses[7], 2, 0.3);  // inside, on a face
  EXPECT_GE(masses.minCoeff(), 0.19 * masses.mean());
}

TEST(ParticleMasses, AtAClampedFaceAreTheControllersToo) {
  // the last layer of a box of 5 x 4 x 5 is held
  const Points grid = Grid(5, 4, 5);
  Recording box = SolidBox();
  box.points.assign(2, grid.leftCols(20));
  box.interior = grid.middleCols(20, 60);
  box.controllers.assign(2, grid.rightCols(20));
  box.rest = box.start = grid;
  const Eigen::VectorXd masses = ParticleMasses(box);
  const double inside = masses[26];
  EXPECT_NEAR(masses.sum(), 0.3, 1e-15);
  EXPECT_NEAR(masses[6] / inside, 0.5, 0.1);   // on the free face
  EXPECT_NEAR(masses[66] / inside, 1.5, 0.2);  // beside the held one
  box.controllers.assign(2, (grid.rightCols(20).colwise() + Eigen::Vector3d(0, 0, 0.01)).eval());
  box.rest.rightCols(20) = box.controllers[0];
  EXPECT_NEAR(ParticleMasses(box)[66] / ParticleMasses(box)[26], 0.5, 0.1);
}

TEST(ParticleMasses, OfOtherBodiesAreAlike) {
  Recording box = SolidBox();
  box.rod = PlainRod(Eigen::VectorXd::LinSpaced(box.rest.cols(), 0, 1));
  EXPECT_EQ(ParticleMasses(box).minCoeff(), ParticleMasses(box).maxCoeff());
  const Recording seen = [] {
    Recording all = SolidBox();
    all.points.assign(2, all.rest.leftCols(40));
    all.interior = all.rest.middleCols(40, 20);
    return all;
  }();
  EXPECT_EQ(ParticleMasses(seen).minCoeff(), ParticleMasses(seen).maxCoeff());
  const Recording rope = SwungRope(8, 2);
  EXPECT_NEAR(ParticleMasses(rope).minCoeff(), rope.mass / 8, 1e-15);
  EXPECT_EQ(ParticleMasses(rope).minCoeff(), ParticleMasses(rope).maxCoeff());
}

}  // namespace
}  // namespace physpring
