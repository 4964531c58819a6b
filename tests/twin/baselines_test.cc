// SPDX-License-Identifier: Apache-2.0
#include "twin/baselines.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/support/plain_rope.h"

namespace physpring {
namespace {

double MeanDistance(const std::vector<Points>& a, const std::vector<Points>& b, int first) {
  double sum = 0;
  for (std::size_t t = first; t < a.size(); ++t) {
    sum += (a[t] - b[t].leftCols(a[t].cols())).colwise().norm().mean();
  }
  return sum / static_cast<double>(a.size() - first);
}

const Baseline& Named(const std::vector<Baseline>& baselines, const std::string& name) {
  for (const Baseline& one : baselines) {
    if (one.name == name) return one;
  }
  throw std::runtime_error(name);
}

// Points that follow the hand 0.2 s later, the farther the less.
Recording Follower(unsigned seed) {
  PlainRope rope;
  rope.noise = 0;
  rope.hand = [seed](double t) {
    return Eigen::Vector3d(0.1 * std::sin((4.0 + seed) * t), 0.1 * std::sin((6.5 - seed) * t), 0);
  };
  Recording recording = rope.Record();
  for (int t = 0; t < recording.frame_count(); ++t) {
    const int then = std::max(0, t - 12);  // at 60 frames a second
    for (int i = 0; i < 11; ++i) {
      recording.points[t].col(i) =
          recording.controllers[t].col(0) - Eigen::Vector3d(0, 0, 0.05 * (i + 1)) +
          0.09 * i * (recording.controllers[then].col(0) - recording.controllers[t].col(0));
    }
  }
  return recording;
}

TEST(LinearPredictor, LearnsWhatIsLinear) {
  const LinearPredictor linear = FitLinearPredictor({Follower(0), Follower(1)});
  const Recording unseen = Follower(2);
  EXPECT_LT(MeanDistance(unseen.points, PredictLinearly(linear, unseen), 0), 1e-6);
}

TEST(LinearPredictor, GoesAlongWithTheControllers) {
  const LinearPredictor linear = FitLinearPredictor({PlainRope().Record()});
  const Recording here = PlainRope().Record();
  const Eigen::Vector3d shift(3, -2, 1);
  const Recording there = Mapped(here, [&](const Eigen::Vector3d& x) { return x + shift; });
  const std::vector<Points> a = PredictLinearly(linear, here), b = PredictLinearly(linear, there);
  EXPECT_LT(((b[50] - a[50]).colwise() - shift).norm(), 1e-12);
}

TEST(LinearPredictor, LearnsFromTracksWithGaps) {
  Recording gaps = Follower(0);
  for (int t = 0; t < 60; t += 3) gaps.points[t + 1].col(4).setConstant(std::nan(""));
  const LinearPredictor linear = FitLinearPredictor({gaps, Follower(1)});
  const Recording unseen = Follower(2);
  EXPECT_LT(MeanDistance(unseen.points, PredictLinearly(linear, unseen), 0), 1e-3);
}

TEST(Baselines, MoveRigidlyWithTheControllers) {
  Recording recording = SideBySide(PlainRope().Record(), PlainRope().Record());
  recording.controllers[0] = Points::Random(3, 3);
  recording.start.conservativeResize(3, 25);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1, Eigen::Vector3d(1, 2, 3).normalized()).matrix();
  const Eigen::Vector3d shift(0.1, 0.2, 0.3);
  for (int t = 1; t < recording.frame_count(); ++t) {
    recording.controllers[t] = (turn * recording.controllers[0]).colwise() + shift;
    recording.points[t] = (turn * recording.points[0]).colwise() + shift;
  }
  const std::vector<Baseline> baselines = PredictBaselines(recording, {});
  ASSERT_EQ(baselines.size(), 2u);
  EXPECT_EQ(baselines[0].name, "motionless");
  EXPECT_LT(MeanDistance(recording.points, Named(baselines, "rigid").particles, 0), 1e-4);
  EXPECT_GT(MeanDistance(recording.points, Named(baselines, "motionless").particles, 0), 0.1);
}

TEST(Baselines, NeedControllersToMove) {
  Recording recording = PlainRope().Record();
  for (Points& frame : recording.controllers) frame.resize(3, 0);
  EXPECT_TRUE(FitLinearPredictor({recording}).empty());
  EXPECT_EQ(PredictBaselines(recording, {}).size(), 1u);
}

}  // namespace
}  // namespace physpring
