// SPDX-License-Identifier: Apache-2.0
// `physpring register`, as a user meets it: what the shape and fits add to clouds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/support/plain_rope.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"
#include "trainer/bodies/start_system.h"
#include "twin/atomic_file.h"
#include "twin/twin.h"
#include "twin/uniform.h"

namespace physpring {
namespace {

using testing::HasSubstr;
using testing::Not;

class Register : public testing::Test {
 protected:
  // Writes what a camera sees of the recording: its points, without names.
  void WriteClouds(Recording recording) {
    std::mt19937_64 random(1);
    for (const Points& points : recording.points) {
      std::vector<int> order(static_cast<std::size_t>(points.cols()));
      for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
      for (std::size_t i = order.size(); i > 1; --i) {
        std::swap(order[i - 1], order[static_cast<std::size_t>(Uniform(&random) * i)]);
      }
      recording.surface.emplace_back(points(Eigen::all, order));
    }
    for (Points& frame : recording.points) frame.resize(3, 0);
    recording.velocity.resize(3, 0);
    recording.rod = Rod();
    WriteRecording(recording, clouds_);
  }

  TemporaryFolder folder_;
  std::string clouds_ = folder_.File("clouds.npz"), known_ = folder_.File("known.npz"),
              mesh_ = folder_.File("sheet.obj"), named_ = folder_.File("named.npz");
};

// A rope whose masses are 5 cm apart: what follows it without knowing it loses some.
TEST_F(Register, NamesPointsAnewByFits) {
  const Recording rope = PlainRope().Record();
  Recording known = rope;
  known.points.resize(2);
  known.controllers.resize(2);
  known.train_frames = 2;
  WriteRecording(known, known_);
  WriteClouds(rope);
  const ProgramResult result =
      RunProgram({"register", clouds_, "--like", known_, "--refine", "-o", named_});
  ASSERT_EQ(result.status, 0) << result.errors;
  EXPECT_THAT(result.errors, HasSubstr("named anew by "));
  EXPECT_THAT(result.errors, Not(HasSubstr("warning: from frame")));
  const Recording named = ReadRecording(named_);
  ASSERT_EQ(named.point_count(), rope.point_count());
  EXPECT_EQ(named.train_frames, rope.train_frames);
  double sum = 0, count = 0;
  for (std::size_t t = 1; t < static_cast<std::size_t>(rope.train_frames); ++t) {
    for (int i = 0; i < rope.point_count(); ++i) {
      if (!named.points[t].col(i).allFinite()) continue;
      sum += (named.points[t].col(i) - rope.points[t].col(i)).norm();
      ++count;
    }
  }
  EXPECT_GT(count, 0.8 * (rope.train_frames - 1) * rope.point_count());
  EXPECT_LT(sum / count, 5e-3);
}

// Its twin says where the points are: they are as many then, in the twin's order.
TEST_F(Register, TakesThePointsOfATwin) {
  const Recording rope = PlainRope().Record();
  Twin twin;
  twin.levels.push_back({MakeStartSystem(rope, {}), {}, 600});
  twin.points = rope.point_count();
  twin.fps = rope.fps;
  const std::string path = folder_.File("rope.twin.npz");
  WriteTwin(twin, path);
  WriteClouds(rope);
  const ProgramResult result = RunProgram({"register", clouds_, "--like", path, "-o", named_});
  ASSERT_EQ(result.status, 0) << result.errors;
  const Recording named = ReadRecording(named_);
  ASSERT_EQ(named.point_count(), rope.point_count());
  EXPECT_LT((named.points[0] - rope.points[0]).colwise().norm().maxCoeff(), 0.02);
  EXPECT_EQ(RunProgram({"eval", path, named_}).status, 0);

  const std::string states = folder_.File("states.npz");
  const ProgramResult tracked = RunProgram({"track", path, clouds_, "--cloud", "-o", states});
  ASSERT_EQ(tracked.status, 0) << tracked.errors;
  EXPECT_THAT(tracked.output, HasSubstr("no point was measured"));
  EXPECT_TRUE(FailsWith(RunProgram({"track", path, clouds_, "-o", folder_.File("none.npz")}),
                        "no 'points'; --cloud follows them"));

  // of a solid one, too: what is inside is where it was brought to in frame 0
  twin.points -= 2;
  twin.interior = 2;
  WriteTwin(twin, path);
  ASSERT_EQ(RunProgram({"register", clouds_, "--like", path, "-o", named_, "--force"}).status, 0);
  EXPECT_EQ(ReadRecording(named_).interior_count(), 2);
  EXPECT_EQ(RunProgram({"eval", path, named_}).status, 0);
}

// A sheet that is carried along, of which one half is seen.
TEST_F(Register, SpreadsPointsOverAMesh) {
  Recording sheet;
  sheet.fps = 30;
  sheet.train_frames = 20;
  for (int t = 0; t < 20; ++t) {
    Points seen(3, 66), hands(3, 2);
    for (int i = 0; i < 66; ++i) {
      const int row = i / 6;
      seen.col(i) << 0.01 * (i % 6), 0.01 * row, 2e-3 * t;
    }
    hands << 0.1, 0.1, 0, 0.1, 2e-3 * t, 2e-3 * t;
    sheet.points.push_back(seen);
    sheet.controllers.push_back(hands);
  }
  WriteClouds(sheet);
  WriteFileAtomically(mesh_, "v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\nf 1 2 3\nf 1 3 4\n");
  const ProgramResult result =
      RunProgram({"register", clouds_, "--shape", mesh_, "--points", "80", "-o", named_});
  ASSERT_EQ(result.status, 0) << result.errors;
  EXPECT_EQ(result.errors, "");
  const Recording named = ReadRecording(named_);
  ASSERT_EQ(named.point_count(), 80);
  EXPECT_GT(named.points[0].row(0).maxCoeff(), 0.09);
  EXPECT_TRUE(FailsWith(
      RunProgram({"register", clouds_, "--shape", clouds_, "-o", folder_.File("other.npz")}),
      "is not a mesh"));
}

}  // namespace
}  // namespace physpring
