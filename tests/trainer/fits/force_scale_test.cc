// SPDX-License-Identifier: Apache-2.0
// A rope that comes to hang at rest: its hand carries its weight.
#include "trainer/fits/force_scale.h"

#include <gtest/gtest.h>

#include "tests/support/swung_rope.h"
#include "trainer/bodies/start_system.h"
#include "twin/effects/registry.h"
#include "twin/predict.h"

namespace physpring {
namespace {

constexpr int kParticles = 8, kFrames = 400;

class HangingRope : public testing::Test {
 protected:
  HangingRope() {
    Recording recording = SwungRope(kParticles, kFrames);
    for (Points& hand : recording.controllers) hand = recording.start.rightCols(1);
    SpringMassSystem system = MakeStartSystem(recording, {});
    ScaleToSubsteps(1 / recording.fps, 20, 0.7, &system);
    system.drag = 4;
    MoveAs(system, true, &recording);
    twin_.levels.push_back({system, {}, 1});
    twin_.points = kParticles;
    twin_.fps = recording.fps;
    recording.force.assign(kFrames, Eigen::MatrixXd::Constant(3, 1, std::nan("")));
    data_.recordings.push_back(recording);
  }

  // The weight of the rope at the end, times `factor`; its size if `rows` is 1.
  void Weigh(double factor, int rows) {
    const double weight = factor * 9.81 * twin_.levels[0].system.mass.sum();
    for (int t = 0; t < kFrames; ++t) {
      Eigen::MatrixXd& force = data_.recordings[0].force[t];
      force = Eigen::MatrixXd::Constant(rows, 1, std::nan(""));
      if (t < kFrames - 20) continue;
      force.setZero();
      force(rows - 1, 0) = weight;
    }
  }

  Twin twin_;
  FitData data_;
};

TEST_F(HangingRope, WeighsAsMuchAsItsHandCarries) {
  for (int rows : {3, 1}) {
    for (double factor : {1.0, 3.0, 0.2}) {
      Weigh(factor, rows);
      Twin twin = twin_;
      ScaleToForces(data_, &twin);
      ASSERT_TRUE(twin.force_scale.has_value());
      EXPECT_NEAR(*twin.force_scale, factor, 2e-3 * factor);
    }
  }
}

TEST_F(HangingRope, MovesAlikeWithAllScaled) {
  Weigh(2, 3);
  Eigen::VectorXd load = Eigen::VectorXd::Zero(GetEffect("mass_distribution").value_count());
  load.head(4) << 0.01, 0, 0, -0.05;  // kg, m
  twin_.levels[0].system.effects = {{"mass_distribution", load}};
  Twin twin = twin_;
  ScaleToForces(data_, &twin);
  const double factor = *twin.force_scale;
  const SpringMassSystem &one = twin_.levels[0].system, &other = twin.levels[0].system;
  EXPECT_EQ(other.mass, factor * one.mass);
  EXPECT_EQ(other.stiffness, factor * one.stiffness);
  EXPECT_EQ(other.dashpot, factor * one.dashpot);
  EXPECT_EQ(other.drag, one.drag);
  EXPECT_EQ(other.effects[0].values[0], factor * 0.01);
  EXPECT_EQ(other.effects[0].values[3], -0.05);
  const PredictOptions options{false, 30};
  const Points before = Predict(twin_, 0, data_.recordings[0], options)[30];
  const Points after = Predict(twin, 0, data_.recordings[0], options)[30];
  EXPECT_LT((after - before).cwiseAbs().maxCoeff(), 1e-9);
}

TEST_F(HangingRope, StaysAsItIsWithoutForces) {
  Twin twin = twin_;
  ScaleToForces(data_, &twin);
  EXPECT_FALSE(twin.force_scale.has_value());
  data_.recordings[0].train_frames = kFrames - 20;  // none in a frame that is fitted
  Weigh(2, 3);
  ScaleToForces(data_, &twin);
  EXPECT_FALSE(twin.force_scale.has_value());
  EXPECT_EQ(twin.levels[0].system.mass, twin_.levels[0].system.mass);
}

TEST_F(HangingRope, LeavesForcesThatAreNotItsOwn) {
  for (double factor : {-1.0, 0.0, 1e6}) {
    Weigh(factor, 3);
    Twin twin = twin_;
    ScaleToForces(data_, &twin);
    EXPECT_FALSE(twin.force_scale.has_value()) << factor;
    EXPECT_EQ(twin.levels[0].system.mass, twin_.levels[0].system.mass);
  }
  // sideways
  Weigh(1, 3);
  for (Eigen::MatrixXd& force : data_.recordings[0].force) std::swap(force(0, 0), force(2, 0));
  Twin twin = twin_;
  ScaleToForces(data_, &twin);
  EXPECT_FALSE(twin.force_scale.has_value());
}

}  // namespace
}  // namespace physpring
