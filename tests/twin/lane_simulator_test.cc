// SPDX-License-Identifier: Apache-2.0
// Each lane gives the bits of its rollout alone, whatever it meets. (Effects: effects_test.cc.)
#include "twin/lane_simulator.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/lanes.h"
#include "tests/support/random_system.h"
#include "twin/error.h"
#include "twin/lane_kernels.h"

namespace physpring {
namespace {

// The same springs with other parameters, masses, drag and contact, and another start.
TargetedRollout Varied(const TargetedRollout& rollout, std::uint64_t seed) {
  Random random(seed);
  TargetedRollout varied = rollout;
  SpringMassSystem& system = varied.system;
  for (Eigen::VectorXd* values : {&system.stiffness, &system.rest_length, &system.dashpot,
                                  &system.mass, &system.contact_radius}) {
    for (double& value : *values) value *= random(0.8, 1.2);
  }
  system.drag = random(0, 3);
  system.contact.surface.friction *= random(0.5, 1);
  system.contact.object.restitution *= random(0.5, 1);
  varied.position += random.Box(static_cast<int>(varied.position.cols()), 1e-3);
  return varied;
}

std::vector<TargetedRollout> Several(const TargetedRollout& rollout, int count) {
  std::vector<TargetedRollout> all;
  for (int i = 0; i < count; ++i) all.push_back(Varied(rollout, 10 + i));
  return all;
}

class LaneSimulatorTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!HasLanes()) GTEST_SKIP() << "this processor has no AVX2";
  }
};

TEST_F(LaneSimulatorTest, GivesTheBitsOfEachAlone) {
  for (int count : {1, 3, 8, 19}) {
    EXPECT_EQ(DifferenceSideBySide(Several(RandomRollout(3, 1), count)), "") << count;
  }
}

TEST_F(LaneSimulatorTest, GivesTheBitsOfEachAloneOnAnInclinedGround) {
  TargetedRollout rollout = RandomRollout(4, 2);
  const Eigen::Vector3d normal = Eigen::Vector3d(0.1, -0.2, 1).normalized();
  rollout.environment.ground = Eigen::Vector4d(normal[0], normal[1], normal[2], -0.06);
  rollout.velocity.row(2).array() -= 1;
  const std::vector<TargetedRollout> all = Several(rollout, 11);
  EXPECT_EQ(DifferenceSideBySide(all), "");
  // they touch it
  TargetedRollout free = all[0];
  free.environment.ground = {};
  EXPECT_NE(Simulate<double>(free).back(), Simulate<double>(all[0]).back());
}

TEST_F(LaneSimulatorTest, GivesTheBitsOfEachAloneWithEitherCone) {
  TargetedRollout rollout = RandomRollout(4, 2);
  rollout.environment.ground = Eigen::Vector4d(0.6, 0, 0.8, -0.06);
  rollout.velocity.row(2).array() -= 1;
  rollout.system.contact.surface.restitution = 0.4;
  std::vector<TargetedRollout> all = Several(rollout, 11);
  for (TargetedRollout& one : all) one.system.contact.surface.cone = FrictionCone::kPyramidal;
  EXPECT_EQ(DifferenceSideBySide(all), "");
  TargetedRollout elliptic = all[4];
  elliptic.system.contact.surface.cone = FrictionCone::kElliptic;
  EXPECT_NE(Simulate<double>(elliptic).back(), Simulate<double>(all[4]).back());
  all[4] = elliptic;
  EXPECT_EQ(DifferenceSideBySide(all), "");
}

TEST_F(LaneSimulatorTest, GivesTheBitsOfEachAloneWhereParticlesCollide) {
  TargetedRollout rollout = RandomRollout(3, 1);
  rollout.position *= 0.6;
  rollout.velocity *= 3;
  rollout.system.contact.collision_distance = 0.03;
  rollout.environment.ground = Eigen::Vector4d(0, 0, 1, -0.05);
  const std::vector<TargetedRollout> all = Several(rollout, 9);
  EXPECT_EQ(DifferenceSideBySide(all), "");
  TargetedRollout apart = all[0];
  apart.system.contact.collision_distance = 0;
  EXPECT_NE(Simulate<double>(apart).back(), Simulate<double>(all[0]).back());
}

TEST_F(LaneSimulatorTest, GivesTheBitsOfEachAloneWithoutSprings) {
  TargetedRollout rollout = RandomRollout(3, 1);
  rollout.system.springs.clear();
  for (Eigen::VectorXd* values :
       {&rollout.system.stiffness, &rollout.system.rest_length, &rollout.system.dashpot}) {
    values->resize(0);
  }
  EXPECT_EQ(DifferenceSideBySide(Several(rollout, 5)), "");
}

TEST_F(LaneSimulatorTest, GivesTheBitsOfEachAloneAmongMovingGeoms) {
  TargetedRollout rollout = RandomRollout(3, 1);
  Geom sphere;
  sphere.radius = 0.04;
  sphere.velocity = {0.1, 0.2, 0.3};
  for (FrameInput& input : rollout.frames) input.geoms = {sphere};
  EXPECT_EQ(DifferenceSideBySide(Several(rollout, 5)), "");
}

TEST_F(LaneSimulatorTest, ALaneThatDivergesDisturbsNoOther) {
  std::vector<TargetedRollout> all = Several(RandomRollout(6, 1), 7);
  all[2].system.stiffness *= 1e9;
  EXPECT_FALSE(Simulate<double>(all[2]).back().allFinite());
  const std::vector<TargetedRollout> others = {all[0], all[1], all[3], all[4], all[5], all[6]};
  std::vector<SpringMassSystem> systems;
  for (const TargetedRollout& one : all) systems.push_back(one.system);
  for (const char* name : {"avx2", "avx512"}) {
    const LaneKernel<float>* kernel = FindLaneKernel<float>(name);
    if (kernel == nullptr) continue;
    LaneSimulator<float> simulator(systems, all[0].environment, all[0].options, *kernel);
    std::vector<NodeStates<float>> states;
    std::vector<NodeStates<float>*> moving;
    for (std::size_t i = 0; i < all.size(); ++i) {
      states.push_back(
          simulator.simulator(static_cast<int>(i)).MakeState(all[i].position, all[i].velocity));
    }
    for (NodeStates<float>& state : states) moving.push_back(&state);
    for (std::size_t frame = 0; frame < 6; ++frame) {
      if (frame == 3) moving[2] = nullptr;  // given up
      simulator.AdvanceFrame(std::vector<FrameInput>(all.size(), all[0].frames[frame]), moving);
    }
    for (std::size_t i : {0, 1, 3, 4, 5, 6}) {
      EXPECT_EQ(simulator.simulator(0).Positions(states[i]), Simulate<float>(all[i]).back()) << i;
    }
  }
}

TEST_F(LaneSimulatorTest, KernelsMoveNumbersSideBySideAndBack) {
  constexpr int kCount = 37;  // squares, and some that are left over
  for (const char* name : {"avx2", "avx512"}) {
    const LaneKernel<double>* kernel = FindLaneKernel<double>(name);
    if (kernel == nullptr) continue;
    std::vector<std::vector<double>> numbers, back(kernel->lanes, std::vector<double>(kCount));
    std::vector<const double*> rows;
    std::vector<double*> back_rows;
    for (int l = 0; l < kernel->lanes; ++l) {
      numbers.emplace_back(kCount);
      for (int i = 0; i < kCount; ++i) numbers[l][i] = 100 * l + i;
    }
    for (int l = 0; l < kernel->lanes; ++l) {
      rows.push_back(numbers[l].data());
      back_rows.push_back(back[l].data());
    }
    LaneArray<double> side_by_side(kCount, kernel->lanes);
    kernel->interleave(rows.data(), kCount, side_by_side.data());
    EXPECT_EQ(side_by_side.data()[kernel->lanes * 20 + 3], 320);
    EXPECT_EQ(side_by_side.data()[kernel->lanes * 36 + 1], 136);
    kernel->separate(side_by_side.data(), kCount, back_rows.data());
    EXPECT_EQ(back, numbers);
  }
}

TEST_F(LaneSimulatorTest, FewRolloutsTakeNarrowRegistersOrNone) {
  EXPECT_EQ(BestLaneKernel<double>(1), nullptr);
  EXPECT_EQ(BestLaneKernel<float>(2), nullptr);
  ASSERT_NE(BestLaneKernel<double>(4), nullptr);
  EXPECT_EQ(BestLaneKernel<double>(4)->lanes, 4);
  EXPECT_EQ(BestLaneKernel<float>(8)->lanes, 8);
  const bool wide = FindLaneKernel<float>("avx512") != nullptr;
  EXPECT_EQ(BestLaneKernel<float>(100)->lanes, wide ? 16 : 8);
}

TEST(AreAlike, SystemsOfOtherSpringsOrEffectsAreNot) {
  const SpringMassSystem system = RandomSystem(10, 1, 1);
  SpringMassSystem other = system;
  other.stiffness *= 2;
  EXPECT_TRUE(AreAlike(system, other));
  other.effects = {{"stiffening", Eigen::VectorXd::Constant(1, 3)}};
  EXPECT_FALSE(AreAlike(system, other));
  other = system;
  std::swap(other.springs[0], other.springs[1]);
  EXPECT_FALSE(AreAlike(system, other));
  other = system;
  other.contact.collision_distance = 0.1;
  EXPECT_FALSE(AreAlike(system, other));
}

}  // namespace
}  // namespace physpring
