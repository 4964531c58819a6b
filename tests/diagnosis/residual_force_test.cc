// SPDX-License-Identifier: Apache-2.0
// A swung rope that is moved by something its model does not know.
#include "diagnosis/residual_force.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "diagnosis/residual_pattern.h"
#include "diagnosis/unexplained.h"
#include "tests/support/random_system.h"
#include "tests/support/swung_rope.h"
#include "trainer/bodies/start_system.h"
#include "twin/effects/registry.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr int kParticles = 8, kFrames = 60;
constexpr double kNoise = 3e-4;
constexpr double kTilt = 0.2;  // rad, about y

struct Case {
  Recording recording = SwungRope(kParticles, kFrames);
  SpringMassSystem system = MakeStartSystem(recording, {});

  Case() {
    ScaleToSubsteps(1 / recording.fps, 30, 0.7, &system);
    system.drag = 5;
  }

  // Lets the rope move with this effect besides, and adds noise.
  void MoveWith(const std::string& effect, const Eigen::VectorXd& values) {
    SpringMassSystem other = system;
    if (!effect.empty()) other.effects.push_back({effect, values});
    MoveAs(other, true, &recording);
    Random random(3);
    for (int t = 1; t < kFrames; ++t) {
      for (double& value : recording.points[static_cast<std::size_t>(t)].reshaped()) {
        value += kNoise * random.Normal();
      }
    }
  }

  void MoveUnderTiltedGravity() { MoveWith("gravity_direction", Eigen::Vector2d(0, kTilt)); }

  ResidualForce Find() const {
    ResidualForceOptions options;
    options.substeps = 40;
    options.deviation = kNoise;
    return FindResidualForce(system, recording, options);
  }
  ResidualPattern Pattern() const { return PatternOf(Find(), system, recording.fps); }
};

// Points that are elsewhere in each frame: no force that is found explains that.
TEST(ResidualForce, SaysThatItDidNotConverge) {
  Case c;
  c.MoveWith("", {});
  EXPECT_TRUE(c.Find().converged);
  Random random(5);
  for (int t = 1; t < kFrames; ++t) {
    for (double& value : c.recording.points[static_cast<std::size_t>(t)].reshaped()) {
      value += 0.5 * random.Normal();
    }
  }
  const ResidualForce lost = c.Find();
  EXPECT_FALSE(lost.converged);
  const ResidualPattern pattern = PatternOf(lost, c.system, c.recording.fps);
  EXPECT_FALSE(pattern.converged);
  const Unexplained left = FindUnexplained(pattern, 0.1, c.recording.fps);
  EXPECT_FALSE(left.converged);
  EXPECT_FALSE(left.located);
}

TEST(ResidualForce, FollowsTheMeasuredMotionUpToItsNoise) {
  Case c;
  c.MoveUnderTiltedGravity();
  const ResidualForce residual = c.Find();
  ASSERT_EQ(residual.force.size(), static_cast<std::size_t>(kFrames - 1));
  ASSERT_EQ(residual.position.size(), static_cast<std::size_t>(kFrames));
  EXPECT_LT(residual.left, 1.05 * kNoise);
  EXPECT_GT(residual.left, 0.7 * kNoise);  // and not what is noise
}

TEST(ResidualForce, OfATiltedGravityIsOneAcceleration) {
  Case c;
  c.MoveUnderTiltedGravity();
  const ResidualPattern pattern = c.Pattern();
  EXPECT_GT(pattern.constant, 0.6);
  // smaller than it was: what acts next to the hand moves nothing
  const double tilted = 9.81 * std::sin(kTilt);
  EXPECT_GT(std::abs(pattern.acceleration[0]), 0.6 * tilted);
  EXPECT_LT(std::abs(pattern.acceleration[0]), 1.1 * tilted);
  EXPECT_NEAR(pattern.acceleration[1], 0, 0.05 * tilted);
  EXPECT_LT(std::abs(pattern.with_velocity), 0.3);
  EXPECT_GT(pattern.root_mean_square, 1.4 * pattern.noise);
}

TEST(ResidualForce, OfADragPointsAgainstTheVelocity) {
  Case c;
  Eigen::VectorXd drag = Eigen::VectorXd::Zero(GetEffect("air_drag").value_count());
  drag[0] = 0.5;
  c.MoveWith("air_drag", drag);
  const ResidualPattern pattern = c.Pattern();
  EXPECT_LT(pattern.with_velocity, -0.6);
  EXPECT_LT(pattern.constant, 0.2);
  // and grows with the speed
  EXPECT_LT(pattern.against_speed.y.back(), 2 * pattern.against_speed.y.front());
  EXPECT_LT(pattern.against_speed.y.back(), 0);
}

TEST(ResidualForce, IsNoMoreThanNoiseWhereNothingIsMissing) {
  Case c;
  c.MoveWith("", {});
  const ResidualPattern pattern = c.Pattern();
  EXPECT_LE(pattern.root_mean_square, 2 * pattern.noise);
}

TEST(ResidualForce, LeavesUnseenFramesAlone) {
  Case c;
  c.MoveUnderTiltedGravity();
  for (int t = kFrames - 10; t < kFrames; ++t) {
    c.recording.points[static_cast<std::size_t>(t)].setConstant(std::nan(""));
  }
  EXPECT_EQ(c.Find().force.size(), static_cast<std::size_t>(kFrames - 11));
}

TEST(ResidualForce, IsNoneWhereNothingWasSeen) {
  Case c;
  for (Points& points : c.recording.points) points.setConstant(std::nan(""));
  EXPECT_TRUE(c.Find().force.empty());
  EXPECT_EQ(c.Pattern().root_mean_square, 0);
}

TEST(ResidualPattern, KnowsPlaceTimeAndFrequency) {
  SpringMassSystem system = RandomSystem(12, 1, 5);
  ResidualForce residual;
  constexpr int kSteps = 50;
  residual.noise = Eigen::VectorXd::Constant(12, 1e-3);
  residual.position.assign(kSteps + 1, system.position.leftCols(12));
  for (int t = 0; t < kSteps; ++t) {
    Points force = Points::Zero(3, 12);
    force(1, 4) = 0.5 * std::cos(2 * std::numbers::pi * 6 * t / kSteps);
    residual.force.push_back(force);
  }
  const ResidualPattern pattern = PatternOf(residual, system, 25);
  EXPECT_NEAR(pattern.root_mean_square, 0.5 / std::sqrt(2 * 12.0), 1e-12);
  EXPECT_NEAR(pattern.noise, std::sqrt(3.0) * 1e-3, 1e-12);
  ASSERT_EQ(pattern.spectrum.size(), 25u);
  EXPECT_NEAR(pattern.spectrum[5], 0.5, 1e-12);  // 6 periods, 3 Hz
  EXPECT_NEAR(pattern.spectrum[6], 0, 1e-12);
  EXPECT_NEAR(pattern.frequency_step, 0.5, 1e-12);
  EXPECT_NEAR(pattern.over_time[0], 0.5 / std::sqrt(12.0), 1e-12);
  EXPECT_NEAR(pattern.mean_force.norm(), 0, 1e-12);
}

}  // namespace
}  // namespace physpring
