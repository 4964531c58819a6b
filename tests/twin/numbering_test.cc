// SPDX-License-Identifier: Apache-2.0
// Points that are numbered otherwise in a second recording of one object are told from an object
// that only starts elsewhere, bent or stretched.
#include "twin/numbering.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <random>

#include "tests/support/small_twin.h"

namespace physpring {
namespace {

Recording RecordingAt(const Points& start) {
  Recording recording;
  recording.name = "first";
  recording.points.emplace_back(start);
  recording.start = start;
  return recording;
}

Points Rope(int points, double spacing) {
  Points rope = Points::Zero(3, points);
  for (int i = 0; i < points; ++i) rope(0, i) = i * spacing;
  return rope;
}

Points Shuffled(const Points& points, unsigned seed) {
  std::vector<int> order(points.cols());
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(seed);
  std::shuffle(order.begin(), order.end(), random);
  Points shuffled(3, points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) shuffled.col(i) = points.col(order[i]);
  return shuffled;
}

TEST(Numbering, OfAnotherOrderIsOdd) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Points rope = Rope(12, 0.02);
    const std::string odd = OddNumbering(RecordingAt(rope), RecordingAt(Shuffled(rope, seed)));
    EXPECT_NE(odd.find("of neighbours in first start more than 2 times as far apart"),
              std::string::npos)
        << seed;
  }
}

TEST(Numbering, OfAStretchedTurnedOrFoldedObjectIsNot) {
  const Points rope = Rope(12, 0.02);
  EXPECT_EQ(OddNumbering(RecordingAt(rope), RecordingAt(1.47 * rope)), "");
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2, Eigen::Vector3d(1, 2, 3).normalized()).matrix();
  EXPECT_EQ(OddNumbering(RecordingAt(rope), RecordingAt(turn * rope)), "");
  Points folded = rope;  // upon itself, 3 mm apart
  for (int i = 6; i < 12; ++i) folded.col(i) << rope(0, 11 - i), 0, 0.003;
  EXPECT_EQ(OddNumbering(RecordingAt(rope), RecordingAt(folded)), "");
  EXPECT_EQ(OddNumbering(RecordingAt(folded), RecordingAt(rope)), "");
}

TEST(Numbering, OfATwinIsComparedAlongItsSprings) {
  const Twin twin = SmallTwin(1);
  Recording recording = RecordingOfMotion(twin, 3);
  EXPECT_EQ(OddNumbering(twin, recording), "");
  recording.start = Shuffled(recording.start, 1);
  EXPECT_NE(OddNumbering(twin, recording).find("the twin"), std::string::npos);
  recording.start = recording.start.leftCols(5).eval();  // another object: not its business
  EXPECT_EQ(OddNumbering(twin, recording), "");
}

}  // namespace
}  // namespace physpring
