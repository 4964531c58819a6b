// SPDX-License-Identifier: Apache-2.0
#include "twin/checks/lost_points.h"

#include <gtest/gtest.h>

#include "tests/support/plain_rope.h"

namespace physpring {
namespace {

constexpr const char* kWhere = "rope.npz: array 'points'";

TEST(LostPoints, AreThoseThatJumpToTheOrigin) {
  std::vector<Points> frames = PlainRope().Record().points;
  const std::vector<Points> whole = frames;
  frames[0].col(3).setZero();
  for (int t = 20; t < 30; ++t) frames[t].rightCols(4).setZero();
  frames.back().col(0).setZero();
  EXPECT_EQ(TakeZerosAsUnseen(kWhere, &frames),
            "rope.npz: array 'points': 42 measurements of 6 points at exactly (0, 0, 0) are taken "
            "as not seen");
  EXPECT_TRUE(frames[0].col(3).array().isNaN().all());
  EXPECT_TRUE(frames[29].rightCols(4).array().isNaN().all());
  EXPECT_EQ(frames[30], whole[30]);
  EXPECT_EQ(frames[19], whole[19]);
}

TEST(LostPoints, AreNoneThatStayAtTheOriginOrPassIt) {
  Recording rope = PlainRope().Record();
  const Eigen::Vector3d offset = rope.points[40].col(5);
  for (Points& frame : rope.points) frame.colwise() -= offset;  // point 5 passes
  for (Points& frame : rope.points) frame.col(0).setZero();     // and point 0 stays
  const std::vector<Points> before = rope.points;
  EXPECT_EQ(TakeZerosAsUnseen(kWhere, &rope.points), "");
  EXPECT_EQ(rope.points, before);
}

}  // namespace
}  // namespace physpring
