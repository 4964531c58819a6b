// SPDX-License-Identifier: Apache-2.0
#include "trainer/motion/rollout.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/gradient_check.h"
#include "tests/support/random_system.h"
#include "tests/support/swung_rope.h"
#include "trainer/bodies/start_system.h"

namespace physpring {
namespace {

constexpr int kFrames = 5, kSubsteps = 40;
constexpr double kNever = std::numeric_limits<double>::infinity();

// A rope of 6 particles with springs that are all different, and a loss that is linear in the
// positions of each frame.
struct Case {
  Recording recording = SwungRope(6, kFrames);
  SpringMassSystem system = MakeStartSystem(recording, {});
  RolloutOptions options{.substeps = kSubsteps, .growth_limit = kNever};
  std::vector<Points> weights;

  Case() {
    Random random(4);
    ScaleToSubsteps(1 / recording.fps, 0.5 * kSubsteps, 0.7, &system);
    for (double& k : system.stiffness) k *= random(0.5, 1);
    for (double& c : system.dashpot) c *= random(0.5, 1);
    for (double& length : system.rest_length) length *= random(0.95, 1.05);
    recording.velocity = random.Box(6, 0.1);
    for (int frame = 0; frame < kFrames; ++frame) weights.push_back(random.Box(6, 1));
  }

  std::unique_ptr<Rollout> Run() const { return RollOut(system, {&recording, kFrames}, options); }
  long double Loss() const {
    const auto rollout = Run();
    long double sum = 0;
    for (int frame = 1; frame < kFrames; ++frame) {
      for (int i = 0; i < 18; ++i) {
        sum += static_cast<long double>(weights[frame].reshaped()[i]) *
               rollout->positions()[frame].reshaped()[i];
      }
    }
    return sum;
  }
};

void ExpectPasses(const Case& c, const std::vector<CheckedVariable>& variables) {
  const GradientReport report = CheckGradient([&c] { return c.Loss(); }, variables);
  EXPECT_TRUE(report.passed) << report.log;
}

// `step` is relative to each value.
std::vector<CheckedVariable> Each(const std::string& name, const Eigen::VectorXd& derivative,
                                  Eigen::VectorXd* values, double step = 3e-3) {
  std::vector<CheckedVariable> variables;
  for (int i = 0; i < values->size(); ++i) {
    variables.push_back(
        {name + std::to_string(i), &(*values)[i], step * (*values)[i], derivative[i]});
  }
  return variables;
}

TEST(Rollout, AdjointAgreesWithDifferences) {
  Case c;
  const RolloutAdjoint adjoint = c.Run()->Adjoint(c.weights);
  EXPECT_EQ(adjoint.cuts, 0);
  ExpectPasses(c, Each("stiffness", adjoint.gradient.stiffness, &c.system.stiffness));
  ExpectPasses(c, Each("dashpot", adjoint.gradient.dashpot, &c.system.dashpot));
  ExpectPasses(c, Each("rest length", adjoint.gradient.rest_length, &c.system.rest_length, 1e-4));
  ExpectPasses(c, Each("mass", adjoint.gradient.mass, &c.system.mass));
  ExpectPasses(c, {{"drag", &c.system.drag, 1e-2, adjoint.gradient.drag}});
}

TEST(Rollout, AdjointIsTheSameOnTwoThreads) {
  Case c;
  const RolloutAdjoint one = c.Run()->Adjoint(c.weights);
  c.options.threads = 2;
  const RolloutAdjoint two = c.Run()->Adjoint(c.weights);
  EXPECT_EQ(one.gradient.stiffness, two.gradient.stiffness);
  EXPECT_EQ(one.gradient.mass, two.gradient.mass);
  EXPECT_EQ(one.velocity_bar, two.velocity_bar);
}

// A measured motion that the body would not take by itself, a point unseen here and there.
void MoveAway(Recording* recording) {
  Random random(7);
  for (int frame = 1; frame < recording->frame_count(); ++frame) {
    recording->points[frame] += random.Box(recording->point_count(), 0.01);
    recording->points[frame].col(frame % recording->point_count())[0] =
        std::numeric_limits<double>::quiet_NaN();
  }
}

TEST(Rollout, AdjointUnderAnObserverAgreesWithDifferences) {
  Case c;
  MoveAway(&c.recording);
  c.options.observer_gain = 0.4;
  const RolloutAdjoint adjoint = c.Run()->Adjoint(c.weights);
  ExpectPasses(c, Each("stiffness", adjoint.gradient.stiffness, &c.system.stiffness));
  ExpectPasses(c, Each("dashpot", adjoint.gradient.dashpot, &c.system.dashpot));
  ExpectPasses(c, Each("mass", adjoint.gradient.mass, &c.system.mass));
  ExpectPasses(c, {{"drag", &c.system.drag, 1e-2, adjoint.gradient.drag}});
}

TEST(Rollout, AnObserverFollowsMeasurementsThatCountLittleLess) {
  Case c;
  MoveAway(&c.recording);
  c.options.observer_gain = 0.4;
  const auto followed = c.Run()->positions();
  c.recording.weight.assign(kFrames, Eigen::MatrixXd::Constant(1, 6, 2));
  EXPECT_EQ(c.Run()->positions(), followed);
  for (Eigen::MatrixXd& weight : c.recording.weight) weight.setConstant(0.5);
  const auto less = c.Run()->positions();
  c.options.observer_gain = 0.2;
  c.recording.weight.clear();
  EXPECT_EQ(c.Run()->positions(), less);
  c.options.observer_gain = 0.4;
  c.recording.weight.assign(kFrames, Eigen::MatrixXd::Constant(1, 6, 0.3));
  const RolloutAdjoint adjoint = c.Run()->Adjoint(c.weights);
  ExpectPasses(c, Each("stiffness", adjoint.gradient.stiffness, &c.system.stiffness));
}

TEST(Rollout, AdjointOfKicksAgreesWithDifferences) {
  Case c;
  MoveAway(&c.recording);
  c.options.observer_gain = 0.3;
  Random random(9);
  std::vector<Points> kicks;
  for (int frame = 0; frame + 1 < kFrames; ++frame) kicks.push_back(random.Box(6, 0.1));
  c.options.kicks = &kicks;
  const RolloutAdjoint adjoint = c.Run()->Adjoint(c.weights);
  ASSERT_EQ(adjoint.kicks_bar.size(), kicks.size());
  std::vector<CheckedVariable> variables;
  for (std::size_t frame = 0; frame < kicks.size(); ++frame) {
    for (int i = 0; i < 18; ++i) {
      variables.push_back({"kick " + std::to_string(frame) + " " + std::to_string(i),
                           &kicks[frame].reshaped()[i], 1e-3,
                           adjoint.kicks_bar[frame].reshaped()[i]});
    }
  }
  ExpectPasses(c, variables);
}

TEST(Rollout, AnObserverKeepsNearWhatIsMeasured) {
  Case c;
  SpringMassSystem other = c.system;
  other.stiffness *= 0.3;
  MoveAs(other, true, &c.recording);
  const auto distance = [&c] {
    return (c.Run()->positions().back() - c.recording.points.back()).norm();
  };
  const double free = distance();
  c.options.observer_gain = 0.5;
  EXPECT_LT(distance(), 0.8 * free);
}

TEST(Rollout, AnObserverLeavesLaterAndUnseenFramesAlone) {
  Case c;
  const auto free = c.Run()->positions();
  MoveAway(&c.recording);
  EXPECT_EQ(c.Run()->positions(), free);  // no observer
  c.options.observer_gain = 0.5;
  const auto followed = c.Run()->positions();
  EXPECT_EQ(followed[1], free[1]);  // corrected after it
  EXPECT_NE(followed[2], free[2]);
  c.recording.points[kFrames - 1].setConstant(1e3);  // after which nothing is left to correct
  EXPECT_EQ(c.Run()->positions(), followed);
  for (Points& points : c.recording.points) {
    points.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  EXPECT_EQ(c.Run()->positions(), free);
}

TEST(Rollout, AdjointOfTheInitialVelocityAgreesWithDifferences) {
  Case c;
  const RolloutAdjoint adjoint = c.Run()->Adjoint(c.weights);
  std::vector<CheckedVariable> variables;
  for (int i = 0; i < 18; ++i) {
    variables.push_back({"velocity " + std::to_string(i), &c.recording.velocity.reshaped()[i], 1e-3,
                         adjoint.velocity_bar.reshaped()[i]});
  }
  ExpectPasses(c, variables);
}

TEST(Rollout, StartsWhereTheRecordingDoes) {
  const Case c;
  const auto rollout = c.Run();
  ASSERT_EQ(rollout->positions().size(), static_cast<std::size_t>(kFrames));
  EXPECT_EQ(rollout->positions()[0], c.recording.start.leftCols(6));
  EXPECT_FALSE(rollout->diverged());
}

// With a cut in every frame only the frame's own sub-steps are differentiated.
TEST(Rollout, CutsAnAdjointThatGrowsTooMuch) {
  Case c;
  const RolloutAdjoint whole = c.Run()->Adjoint(c.weights);
  c.options.growth_limit = 1e-9;
  const RolloutAdjoint cut = c.Run()->Adjoint(c.weights);
  EXPECT_EQ(cut.cuts, kFrames - 1);
  std::vector<Points> first_only(kFrames, Points::Zero(3, 6));
  first_only[1] = c.weights[1];
  c.options.growth_limit = kNever;
  EXPECT_EQ(cut.velocity_bar, c.Run()->Adjoint(first_only).velocity_bar);
  EXPECT_NE(cut.velocity_bar, whole.velocity_bar);
}

TEST(Rollout, SaysThatItDiverged) {
  Case c;
  c.system.stiffness *= 1e4;
  const auto rollout = c.Run();
  EXPECT_TRUE(rollout->diverged());
  EXPECT_LT(rollout->positions().size(), static_cast<std::size_t>(kFrames));
  for (const Points& position : rollout->positions()) EXPECT_TRUE(position.allFinite());
}

TEST(Rollout, SinglePrecisionIsCloseToDouble) {
  Case c;
  const auto exact = c.Run();
  const RolloutAdjoint adjoint = exact->Adjoint(c.weights);
  c.options.single_precision = true;
  const auto single = c.Run();
  EXPECT_LT((single->positions().back() - exact->positions().back()).norm(), 1e-5);
  EXPECT_NE(single->positions().back(), exact->positions().back());
  const Eigen::VectorXd& expected = adjoint.gradient.stiffness;
  EXPECT_LT((single->Adjoint(c.weights).gradient.stiffness - expected).norm(),
            1e-3 * expected.norm());
}

}  // namespace
}  // namespace physpring
