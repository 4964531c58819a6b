// SPDX-License-Identifier: Apache-2.0
// Meshes in the frame and unit of the points, and in others.
#include "exporter/mesh_place.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "exporter/surface_nets.h"
#include "tests/support/mesh_files.h"
#include "tests/support/random_system.h"
#include "tests/support/temporary_folder.h"
#include "twin/error.h"

namespace physpring {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const Eigen::Vector3d kPlace(0.3, -0.1, 0.2);  // m, of the toy's middle

// A toy: a ball of radius 0.08 m with a head of 0.055 m. Distance of `x` to its surface, negative
// inside.
double ToToy(const Eigen::Vector3d& x) {
  const Eigen::Vector3d ball = x - kPlace, head = ball - Eigen::Vector3d(0.03, 0, 0.11);
  return std::min(ball.norm() - 0.08, head.norm() - 0.055);
}

TriangleMesh Toy() {
  Grid grid(kPlace - Eigen::Vector3d::Constant(0.12), 0.008, {31, 31, 40});
  for (int i = 0; i < grid.count(); ++i) grid.value(i) = ToToy(grid.Position(i));
  return SurfaceNets(grid);
}

// Points of the surface, measured with noise of that deviation per axis, in m.
Points OnToy(int count, double noise) {
  Random random(7);
  Points points(3, count);
  for (int i = 0; i < count;) {
    const Eigen::Vector3d direction =
        Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized();
    const bool head = random(0, 1) < 0.4;
    const Eigen::Vector3d x = kPlace + (head ? Eigen::Vector3d(0.03, 0, 0.11) + 0.055 * direction
                                             : Eigen::Vector3d(0.08 * direction));
    if (ToToy(x) < -1e-9) continue;
    points.col(i++) =
        x + noise * Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal());
  }
  return points;
}

using Change = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

TriangleMesh Changed(TriangleMesh mesh, const Change& change) {
  for (auto x : mesh.vertices.colwise()) x = change(x);
  return mesh;
}

Eigen::Vector3d YUp(const Eigen::Vector3d& x) { return {x[0], x[2], -x[1]}; }

class MeshPlace : public testing::Test {
 protected:
  // The toy, changed and written as that file, then read for the points.
  PlacedMesh Read(const std::string& name, const Change& change, const Points& points) const {
    const TriangleMesh mesh = Changed(Toy(), change);
    if (name.find(".glb") != std::string::npos) {
      WriteGlb(mesh, folder_.File(name));
    } else {
      WriteObj(mesh, folder_.File(name));
    }
    return ReadMeshAt(folder_.File(name), points);
  }

  std::string Refusal(const std::string& name, const Change& change) const {
    try {
      Read(name, change, OnToy(300, 0.002));
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  TemporaryFolder folder_;
};

// 1e-6: files of glTF are in single precision.
void ExpectToy(const TriangleMesh& mesh) {
  const TriangleMesh toy = Toy();
  EXPECT_EQ(mesh.faces.size(), toy.faces.size());
  EXPECT_LT((mesh.vertices.rowwise().maxCoeff() - toy.vertices.rowwise().maxCoeff()).norm(), 1e-6);
  EXPECT_LT((mesh.vertices.rowwise().minCoeff() - toy.vertices.rowwise().minCoeff()).norm(), 1e-6);
  EXPECT_LT((mesh.vertices.colwise() - kPlace).colwise().norm().minCoeff(), 0.081);
}

const Change kSame = [](const Eigen::Vector3d& x) { return x; };

TEST_F(MeshPlace, FollowsTheRuleOfTheFormat) {
  const Points points = OnToy(300, 0.002);
  for (const auto& [name, change] :
       {std::pair<std::string, Change>{"z.obj", kSame}, {"y.glb", YUp}, {"y.GLB", YUp}}) {
    const PlacedMesh placed = Read(name, change, points);
    EXPECT_THAT(placed.warnings, ElementsAre()) << name;
    ExpectToy(placed.mesh);
  }
}

TEST_F(MeshPlace, TakesTheOtherWayUpWhereOnlyThatFits) {
  const Points points = OnToy(300, 0.002);
  const PlacedMesh z_up = Read("z.glb", kSame, points);
  EXPECT_THAT(z_up.warnings,
              ElementsAre(HasSubstr("z.glb: taken as z up, against the rule of its format, because "
                                    "then the measured points are 0.00")));
  ExpectToy(z_up.mesh);
  const PlacedMesh y_up = Read("y.obj", YUp, points);
  EXPECT_THAT(y_up.warnings, ElementsAre(HasSubstr("y.obj: taken as y up, and turned to z up")));
  ExpectToy(y_up.mesh);
}

TEST_F(MeshPlace, TakesCentimetresAndMillimetres) {
  const Points points = OnToy(300, 0.002);
  const PlacedMesh cm = Read(
      "cm.obj", [](const Eigen::Vector3d& x) { return Eigen::Vector3d(100 * x); }, points);
  EXPECT_THAT(cm.warnings, ElementsAre(HasSubstr("cm.obj: taken as centimetres, because")));
  ExpectToy(cm.mesh);
  const PlacedMesh mm = Read(
      "mm.obj", [](const Eigen::Vector3d& x) { return Eigen::Vector3d(1000 * YUp(x)); }, points);
  EXPECT_THAT(mm.warnings, ElementsAre(HasSubstr("mm.obj: taken as millimetres, because"),
                                       HasSubstr("mm.obj: taken as y up")));
  ExpectToy(mm.mesh);
}

TEST_F(MeshPlace, AMeshElsewhereIsRefusedWithDistanceAndSizes) {
  const std::string centred =
      Refusal("centred.obj", [](const Eigen::Vector3d& x) { return Eigen::Vector3d(x - kPlace); });
  EXPECT_THAT(
      centred,
      testing::MatchesRegex(
          ".*/centred.obj: the measured points are 0.2[0-9]* m from the mesh on average, expected "
          "less than 0.01 m \\(their spacing is 0.01 m\\); is the mesh in another frame or unit\\? "
          "the mesh measures 0.16[0-9]* x 0.16[0-9]* x 0.24[0-9]* m around \\(0.0.*\\), the points "
          "0.1[0-9]* x .* m around \\(0.3[0-9]*, -0.1[0-9]*, 0.2[0-9]*\\)"));
}

TEST_F(MeshPlace, WhatIsNearButWrongIsRefused) {
  const auto about = [](const Eigen::Matrix3d& map) {
    return [map](const Eigen::Vector3d& x) { return Eigen::Vector3d(kPlace + map * (x - kPlace)); };
  };
  Eigen::Matrix3d quarter, upside;
  quarter << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  upside = Eigen::Vector3d(1, -1, -1).asDiagonal();
  const Eigen::Vector3d pivot(0, 0.02, 0.04);  // a third of the ball's size
  for (const auto& [name, change] :
       {std::pair<std::string, Change>{
            "pivot.obj", [&](const Eigen::Vector3d& x) { return Eigen::Vector3d(x + pivot); }},
        {"lying.obj", about(quarter)},
        {"upside.obj", about(upside)},
        {"large.obj", about(1.25 * Eigen::Matrix3d::Identity())},
        {"small.obj", about(0.8 * Eigen::Matrix3d::Identity())},
        {"inches.obj", [](const Eigen::Vector3d& x) { return Eigen::Vector3d(x / 0.0254); }},
        {"pivot.glb", [&](const Eigen::Vector3d& x) { return YUp(Eigen::Vector3d(x + pivot)); }}}) {
    EXPECT_THAT(Refusal(name, change), HasSubstr(" m from the mesh on average")) << name;
  }
}

TEST_F(MeshPlace, PointsMayBeNoisyFewOrOnOneSide) {
  EXPECT_NO_THROW(Read("noisy.obj", kSame, OnToy(300, 0.005)));
  EXPECT_NO_THROW(Read("few.obj", kSame, OnToy(20, 0.002)));
  EXPECT_NO_THROW(Read("two.obj", kSame, OnToy(2, 0.002)));
  const Points all = OnToy(600, 0.002);
  std::vector<Eigen::Index> seen;
  for (Eigen::Index i = 0; i < all.cols(); ++i) {
    if (all(1, i) < kPlace[1]) seen.push_back(i);
  }
  EXPECT_NO_THROW(Read("side.obj", kSame, all(Eigen::all, seen)));
}

// A mesh in millimetres may lie with a side along the points.
TEST_F(MeshPlace, AFarLargerMeshDoesNotFit) {
  TriangleMesh wall;
  wall.vertices = Points{{0, 5, 5, 0}, {0, 0, 5, 5}, {0, 0, 0, 0}};
  wall.faces = {{0, 1, 2}, {0, 2, 3}};
  WriteObj(wall, folder_.File("wall.obj"));
  Points points = 0.1 * Random(1).Box(50, 1).cwiseAbs();
  points.row(2).setZero();
  try {
    ReadMeshAt(folder_.File("wall.obj"), points);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("wall.obj: is 5"));
    EXPECT_THAT(error.what(), HasSubstr(" times as large as the measured points, expected less "
                                        "than 10; is the mesh in another frame or unit?"));
  }
}

// As a simulated solid has them.
TEST_F(MeshPlace, PointsMayFillTheBody) {
  const double spacing = 0.015;
  std::vector<Eigen::Vector3d> inside;
  for (int i = 0; i < 25 * 25 * 25; ++i) {
    const Eigen::Vector3d x =
        kPlace +
        spacing *
            (Eigen::Vector3i(i % 25, i / 25 % 25, i / 625).array() - 12).matrix().cast<double>();
    if (ToToy(x) < 0) inside.push_back(x);
  }
  Points points(3, static_cast<Eigen::Index>(inside.size()));
  for (std::size_t i = 0; i < inside.size(); ++i) points.col(static_cast<int>(i)) = inside[i];
  EXPECT_THAT(Read("full.obj", kSame, points).warnings, ElementsAre());
  const Change apart = [](const Eigen::Vector3d& x) { return Eigen::Vector3d(x.array() + 0.05); };
  EXPECT_THROW(Read("apart.obj", apart, points), Error);
}

TEST_F(MeshPlace, OfTwoWaysUpThatFitTheRuleCounts) {
  // the same from all sides
  Grid grid({-0.12, -0.12, -0.12}, 0.01, {25, 25, 25});
  for (int i = 0; i < grid.count(); ++i) grid.value(i) = grid.Position(i).norm() - 0.1;
  WriteGlb(SurfaceNets(grid), folder_.File("ball.glb"));
  Points points = OnToy(300, 0).colwise() - kPlace;
  points = 0.1 * points.colwise().normalized();
  EXPECT_THAT(ReadMeshAt(folder_.File("ball.glb"), points).warnings, ElementsAre());
}

}  // namespace
}  // namespace physpring
