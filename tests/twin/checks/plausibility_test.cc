// SPDX-License-Identifier: Apache-2.0
#include "twin/checks/plausibility.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/plain_rope.h"

namespace physpring {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Oddities, AreNoneInARopeThatHangs) {
  EXPECT_THAT(FindOddities(PlainRope().Record()), IsEmpty());
}

TEST(Oddities, TellCentimetresFromMetres) {
  const Recording cm =
      Mapped(PlainRope().Record(), [](const Eigen::Vector3d& x) { return 100 * x; });
  EXPECT_THAT(FindOddities(cm), ElementsAre(HasSubstr("the object measures 50")));
  const Recording small =
      Mapped(PlainRope().Record(), [](const Eigen::Vector3d& x) { return 1e-3 * x; });
  EXPECT_THAT(FindOddities(small), ElementsAre(HasSubstr("are positions in metres?")));
}

TEST(Oddities, TellAFrameRateThatIsTenTimesTooHigh) {
  Recording recording = PlainRope().Record();
  recording.fps *= 10;
  EXPECT_THAT(FindOddities(recording), ElementsAre(HasSubstr("is fps 600 right?")));
}

TEST(Oddities, TellAnotherAxisThatPointsUp) {
  const Recording y_up = Mapped(PlainRope().Record(), [](const Eigen::Vector3d& x) {
    return Eigen::Vector3d(x[0], x[2], -x[1]);
  });
  EXPECT_THAT(FindOddities(y_up), ElementsAre(HasSubstr("which axis points up?")));
  const Recording z_down = Mapped(PlainRope().Record(), [](const Eigen::Vector3d& x) {
    return Eigen::Vector3d(x[0], x[1], -x[2]);
  });
  EXPECT_THAT(FindOddities(z_down), ElementsAre(HasSubstr("which axis points up?")));
}

TEST(Oddities, TellASceneWhereNothingMoves) {
  PlainRope rope;
  rope.before = 8;
  rope.hand = [](double) { return Eigen::Vector3d(0, 0, 0); };
  Recording frozen = rope.Record();
  EXPECT_THAT(FindOddities(frozen), ElementsAre(HasSubstr("nothing moves")));
  for (int t = 0; t < frozen.frame_count(); ++t) frozen.controllers[t](0, 0) += 0.002 * t;
  EXPECT_THAT(FindOddities(frozen), ElementsAre(HasSubstr("while the controllers move by")));
}

TEST(Oddities, TellARodThatIsNotTheObjects) {
  Recording rope = PlainRope().Record();
  RodEdges along;
  for (int i = 0; i + 1 < rope.particle_count(); ++i) along.push_back({i, i + 1});
  rope.rod = RodOfEdges(along, rope.rest);
  EXPECT_THAT(FindOddities(rope), IsEmpty());
  rope.rod = RodOfEdges(along, 2 * rope.rest);
  EXPECT_THAT(FindOddities(rope), ElementsAre(HasSubstr("the rod is 2 times as long")));
  RodEdges scrambled;  // from one half of the rope to the other one and back
  const int half = rope.particle_count() / 2;
  for (int i = 0; i < half; ++i) {
    scrambled.push_back({i, i + half});
    if (i + 1 < half) scrambled.push_back({i + 1, i + half});
  }
  rope.rod = RodOfEdges(scrambled, rope.rest);
  EXPECT_THAT(FindOddities(rope), ElementsAre(HasSubstr("follow each other along the rod")));
}

TEST(Oddities, TellAWristFromAGrasp) {
  Recording wrist = PlainRope().Record();
  for (Points& frame : wrist.controllers) frame.row(2).array() += 0.1;
  wrist.start.col(11)[2] += 0.1;
  EXPECT_THAT(FindOddities(wrist),
              ElementsAre(HasSubstr("controller 0 starts 0.149 m from the nearest particle")));
}

TEST(Oddities, TellARelease) {
  PlainRope rope;
  rope.released = 1;
  EXPECT_THAT(FindOddities(rope.Record()), ElementsAre(HasSubstr("was the object released?")));
}

TEST(Oddities, TellAGroundThatDoesNotSupport) {
  Recording recording = PlainRope().Record();
  recording.ground = Eigen::Vector4d(0, 1, 0, -1);
  EXPECT_THAT(FindOddities(recording), ElementsAre(HasSubstr("does not pull towards the ground")));
  recording.ground = Eigen::Vector4d(0, 0, 1, 0.8);
  EXPECT_THAT(FindOddities(recording), ElementsAre(HasSubstr("m below the ground")));
  recording.ground = Eigen::Vector4d(0, 0, 1, 0.2);
  EXPECT_THAT(FindOddities(recording), IsEmpty());
}

TEST(Oddities, TellALyingObjectWithoutAGround) {
  PlainRope rope;
  rope.along = {1, 0, 0};
  rope.hand = [](double t) { return Eigen::Vector3d(0, 0, 0.15 * t); };
  EXPECT_THAT(FindOddities(rope.Record()), IsEmpty()) << "it falls from where it was";
  rope.floor = 1;
  Recording lifted = rope.Record();
  EXPECT_THAT(FindOddities(lifted), ElementsAre(HasSubstr("lies flat at a height of 0.999 m")));
  lifted.ground = Eigen::Vector4d(0, 0, 1, 1);
  EXPECT_THAT(FindOddities(lifted), IsEmpty());
}

TEST(TooLittle, IsExplainedByATwinThatLeavesHalf) {
  EXPECT_EQ(TooLittleExplained(0.04, 0.1, 5e-4), "");
  EXPECT_THAT(TooLittleExplained(0.048, 0.1, 5e-4), HasSubstr("explains 52 %"));
  EXPECT_THAT(TooLittleExplained(0.08, 0.1, 5e-4),
              HasSubstr("explains 20 % of the motion (80 of 100"));
  EXPECT_THAT(TooLittleExplained(0.2, 0.1, 5e-4), HasSubstr("explains 0 %"));
  EXPECT_EQ(TooLittleExplained(0.002, 0.002, 5e-4), "") << "what moves is noise";
}

}  // namespace
}  // namespace physpring
