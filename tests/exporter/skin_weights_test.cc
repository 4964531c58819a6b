// SPDX-License-Identifier: Apache-2.0
#include "exporter/skin_weights.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/support/random_system.h"

namespace physpring {
namespace {

// The vertices when the nodes have moved.
Points Carry(const Points& vertices, const Points& nodes, const Points& moved) {
  Points carried = Points::Zero(3, vertices.cols());
  const auto bound = BindToNodes(vertices, nodes);
  for (Eigen::Index node = 0; node < nodes.cols(); ++node) {
    for (const SkinWeight& weight : bound[node]) {
      carried.col(weight.vertex) +=
          weight.weight * (vertices.col(weight.vertex) + moved.col(node) - nodes.col(node));
    }
  }
  return carried;
}

const Eigen::Matrix3d kTurn =
    Eigen::AngleAxisd(1.5, Eigen::Vector3d(1, -1, 2).normalized()).toRotationMatrix();

TEST(SkinWeights, VerticesStayWhereNodesDo) {
  Random random(1);
  const Points nodes = random.Box(100, 1), vertices = random.Box(50, 1.2);
  EXPECT_LT((Carry(vertices, nodes, nodes) - vertices).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(SkinWeights, VerticesMoveAlong) {
  Random random(1);
  const Points nodes = random.Box(5, 1), vertices = random.Box(50, 1.2);
  const Eigen::Vector3d way(1, 2, 3);
  const Points carried = Carry(vertices, nodes, nodes.colwise() + way);
  EXPECT_LT((carried - (vertices.colwise() + way)).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(SkinWeights, VerticesTurnWithTheirNodes) {
  Random random(1);
  const Points nodes = random.Box(400, 1), vertices = random.Box(50, 0.9);
  const Points carried = Carry(vertices, nodes, kTurn * nodes);
  // exact but for the regularisation
  EXPECT_LT((carried - kTurn * vertices).colwise().norm().mean(), 0.01);
}

TEST(SkinWeights, ASheetTurnsInSpace) {
  Random random(1);
  Points nodes = random.Box(400, 1), vertices = random.Box(50, 0.9);
  nodes.row(2).setZero();
  vertices.row(2).setZero();
  const Points carried = Carry(vertices, nodes, kTurn * nodes);
  EXPECT_LT((carried - kTurn * vertices).colwise().norm().mean(), 0.01);
}

TEST(SkinWeights, ALineOfNodesIsNoProblem) {
  Points nodes = Points::Zero(3, 10);
  for (int i = 0; i < 10; ++i) nodes(0, i) = i;
  Random random(1);
  const Points vertices = random.Box(50, 1);
  EXPECT_LT((Carry(vertices, nodes, nodes) - vertices).cwiseAbs().maxCoeff(), 1e-12);
  for (const auto& bound : BindToNodes(vertices, nodes)) {
    for (const SkinWeight& weight : bound) EXPECT_LT(std::abs(weight.weight), 3);
  }
}

}  // namespace
}  // namespace physpring
