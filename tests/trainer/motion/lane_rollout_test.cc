// SPDX-License-Identifier: Apache-2.0
#include "trainer/motion/lane_rollout.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/random_system.h"
#include "tests/support/swung_rope.h"
#include "trainer/bodies/start_system.h"

namespace physpring {
namespace {

constexpr int kFrames = 6, kSubsteps = 40;

struct Case {
  Recording recording = SwungRope(6, kFrames);
  SpringMassSystem system = MakeStartSystem(recording, {});
  RolloutOptions options{.substeps = kSubsteps};

  Case() {
    ScaleToSubsteps(1 / recording.fps, 0.5 * kSubsteps, 0.7, &system);
    recording.ground = Eigen::Vector4d(0, 0, 1, recording.start.row(2).minCoeff() - 1e-3);
    recording.points[2].col(3).setConstant(std::numeric_limits<double>::quiet_NaN());
  }

  std::vector<SpringMassSystem> Several(int count) const {
    Random random(3);
    std::vector<SpringMassSystem> systems(count, system);
    for (SpringMassSystem& one : systems) {
      for (double& k : one.stiffness) k *= random(0.5, 1);
      one.drag = random(0, 1);
    }
    return systems;
  }
  Episode All() const { return {&recording, kFrames}; }
  // Whether each of the systems moves as it does alone.
  void ExpectAsAlone(const std::vector<SpringMassSystem>& systems) const {
    const auto motions = RollOutSideBySide(systems, All(), options);
    ASSERT_EQ(motions.size(), systems.size());
    for (std::size_t i = 0; i < systems.size(); ++i) {
      const auto alone = RollOut(systems[i], All(), options);
      ASSERT_EQ(motions[i].has_value(), !alone->diverged()) << i;
      if (motions[i]) {
        EXPECT_EQ(*motions[i], alone->positions()) << i;
      }
    }
  }
};

TEST(LaneRollout, MovesEachSystemAsAlone) {
  for (bool single : {false, true}) {
    for (double gain : {0.0, 0.2}) {
      Case c;
      c.options.single_precision = single;
      c.options.observer_gain = gain;
      for (int count : {1, 5, 8, 21}) c.ExpectAsAlone(c.Several(count));
    }
  }
}

TEST(LaneRollout, ObservesTheFramesInUse) {
  Case c;
  c.options.observer_gain = 0.5;
  std::vector<FrameUse> use(kFrames, FrameUse::kFit);
  use[2] = FrameUse::kNone;
  const std::vector<SpringMassSystem> systems = c.Several(4);
  const Episode episode{&c.recording, kFrames, &use};
  const auto motions = RollOutSideBySide(systems, episode, c.options);
  for (std::size_t i = 0; i < systems.size(); ++i) {
    EXPECT_EQ(*motions[i], RollOut(systems[i], episode, c.options)->positions());
  }
}

TEST(LaneRollout, OneThatDivergesIsMissingAndDisturbsNoOther) {
  Case c;
  c.options.substeps = 4;
  std::vector<SpringMassSystem> systems = c.Several(6);
  for (SpringMassSystem& system : systems) system.stiffness *= 0.01;
  systems[1].stiffness *= 1e8;
  systems[4].stiffness *= 1e5;
  c.ExpectAsAlone(systems);
  const auto motions = RollOutSideBySide(systems, c.All(), c.options);
  EXPECT_FALSE(motions[1]);
  EXPECT_TRUE(motions[0]);
}

TEST(LaneRollout, DelaysTheControllersOfEachSystemByItsOwnLatency) {
  Case c;
  std::vector<SpringMassSystem> systems = c.Several(5);
  for (std::size_t i = 0; i < systems.size(); ++i) {
    systems[i].effects = {
        {"control_latency", Eigen::VectorXd::Constant(1, 0.003 * static_cast<double>(i))}};
  }
  c.ExpectAsAlone(systems);
}

TEST(LaneRollout, SystemsOfOtherSpringsFollowOneAnother) {
  const Case c;
  std::vector<SpringMassSystem> systems = c.Several(4);
  std::swap(systems[2].springs[0], systems[2].springs[1]);
  c.ExpectAsAlone(systems);
}

}  // namespace
}  // namespace physpring
