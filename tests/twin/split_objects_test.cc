// SPDX-License-Identifier: Apache-2.0
#include "twin/split_objects.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/plain_rope.h"
#include "tests/support/temporary_folder.h"
#include "twin/checks/objects.h"

namespace physpring {
namespace {

// Two ropes of 11 points, each in a hand.
TEST(SplitObjects, MakesARecordingOfEachRope) {
  Recording ropes = TwoRopes();
  ropes.name = "ropes";
  ropes.mass = 0.3;
  ropes.object = FindObjects(ropes);
  ropes.surface = ropes.points;
  ropes.track = ropes.points;
  const std::vector<Recording> parts = SplitObjects(ropes);
  ASSERT_EQ(parts.size(), 2u);
  const TemporaryFolder folder;
  for (int object = 0; object < 2; ++object) {
    const Recording& part = parts[static_cast<std::size_t>(object)];
    EXPECT_EQ(part.name, object == 0 ? "ropes_object0" : "ropes_object1");
    EXPECT_EQ(part.point_count(), 11);
    EXPECT_DOUBLE_EQ(part.mass, 0.15);
    const auto middle = static_cast<std::size_t>(ropes.frame_count() / 2);
    EXPECT_EQ(part.points[middle], ropes.points[middle].middleCols(11 * object, 11));
    EXPECT_EQ(part.track[middle], part.points[middle]);
    EXPECT_EQ(part.controllers[middle], ropes.controllers[middle].col(object));
    EXPECT_EQ(part.start.rightCols(1), ropes.start.col(22 + object));
    EXPECT_EQ(part.rest.cols(), 12);
    EXPECT_EQ(part.velocity.cols(), 11);
    for (int i = 0; i < 22; ++i) {
      EXPECT_EQ(std::isnan(part.surface[middle](0, i)), i / 11 != object) << i;
    }
    const std::string path = folder.File(part.name + ".npz");
    WriteRecording(part, path);
    EXPECT_EQ(ReadRecording(path).object.size(), 0);
  }
}

TEST(SplitObjects, LeavesOneObjectAsItIs) {
  const Recording rope = PlainRope().Record();
  const std::vector<Recording> parts = SplitObjects(rope);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].points, rope.points);
}

}  // namespace
}  // namespace physpring
