// SPDX-License-Identifier: Apache-2.0
#include "twin/checks/objects.h"

#include <gtest/gtest.h>

#include "tests/support/plain_rope.h"

namespace physpring {
namespace {

TEST(Objects, OfOneRopeAreNotCounted) { EXPECT_EQ(FindObjects(PlainRope().Record()).size(), 0); }

TEST(Objects, OfTwoRopesAreTwo) {
  const Eigen::VectorXi object = FindObjects(TwoRopes());
  ASSERT_EQ(object.size(), 24);
  for (int i = 0; i < 22; ++i) EXPECT_EQ(object[i], i < 11 ? 0 : 1) << i;
  EXPECT_EQ(object[22], 0);
  EXPECT_EQ(object[23], 1);
}

// Nothing stays together with anything: that is no object, but one that stretches.
TEST(Objects, OfWhatSpreadsAreNotCounted) {
  Recording recording = PlainRope().Record();
  for (int t = 0; t < 120; ++t) recording.points[t] *= 1 + 0.05 * t;
  EXPECT_EQ(FindObjects(recording).size(), 0);
}

}  // namespace
}  // namespace physpring
