// SPDX-License-Identifier: Apache-2.0
// Small sheets that hang from two hands, moved by MuJoCo (tendons), with and without something that
// the twin's model does not know.
#include "diagnosis/diagnosis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/random_system.h"
#include "tests/support/tendon_oracle.h"
#include "trainer/bodies/factors.h"
#include "twin/effects/registry.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr int kAcross = 4, kDown = 4, kFrames = 60, kSteps = 10;  // steps of MuJoCo a frame
constexpr double kSpacing = 0.03, kNoise = 3e-4;
constexpr double kFps = 50;

// Points of a regular sheet, the two upper corners last: they are held. `phase` makes another
// motion.
Recording HungSheet(double phase) {
  Recording recording;
  recording.name = "sheet";
  recording.hash = "made here";
  recording.fps = kFps;
  recording.mass = 0.02;
  recording.train_frames = kFrames;
  const int nodes = kAcross * kDown - 2;
  recording.start.resize(3, nodes + 2);
  int node = 0;
  for (int i = 0; i < kAcross; ++i) {
    for (int j = 0; j < kDown; ++j) {
      const bool held = j == 0 && (i == 0 || i == kAcross - 1);
      const int column = held ? nodes + (i == 0 ? 0 : 1) : node++;
      recording.start.col(column) = Eigen::Vector3d(kSpacing * i, kSpacing * j, 0.6);
    }
  }
  recording.rest = recording.start;
  recording.interior.resize(3, 0);
  recording.velocity = Points::Zero(3, nodes);
  for (int t = 0; t < kFrames; ++t) {
    const double time = t / kFps;
    const Eigen::Vector3d moved(0.03 * std::sin(7 * time + phase) - 0.03 * std::sin(phase),
                                0.02 * std::sin(5 * time), 0.03 * std::sin(9 * time));
    recording.controllers.emplace_back(recording.start.rightCols(2).colwise() + moved);
    recording.points.emplace_back(recording.start.leftCols(nodes));
  }
  return recording;
}

SpringMassSystem SheetSystem(const Recording& recording) {
  SpringMassSystem system = StartSystem(recording, {&SpringNet(), 12, 2.2 * kSpacing, false}, 12);
  system.drag = 1.5;
  system.dashpot *= 0.1;
  return system;
}

// Lets MuJoCo move the recording's points, and adds noise.
void MoveByMujoco(const SpringMassSystem& system, const Eigen::Vector3d& gravity,
                  Recording* recording) {
  const double h = 1 / (kFps * kSteps);
  TendonOracle oracle(system, gravity, h);
  Random random(7);
  for (int t = 1; t < kFrames; ++t) {
    const Points &from = recording->controllers[t - 1], &to = recording->controllers[t];
    for (int step = 1; step <= kSteps; ++step) {
      oracle.Step(from + static_cast<double>(step) / kSteps * (to - from));
    }
    recording->points[t] = oracle.Positions();
    for (double& value : recording->points[t].reshaped()) {
      value += kNoise * std::sqrt(-2 * std::log(1 - random(0, 1))) *
               std::cos(2 * std::numbers::pi * random(0, 1));
    }
  }
}

// A twin that was trained on the recording.
Twin TwinOf(const SpringMassSystem& system, const Recording& recording) {
  Twin twin;
  twin.levels.push_back({system, {}, static_cast<int>(kFps) * kSteps});
  twin.points = recording.point_count();
  twin.fps = kFps;
  twin.controller_velocity = false;
  twin.trained_on.push_back({recording.name, recording.hash, recording.train_frames});
  return twin;
}

DiagnosisOptions OneEffect() {
  DiagnosisOptions options;
  options.threads = 2;
  options.most_effects = 1;
  return options;
}

// The diagnosis of a twin that was trained on the first of two motions, judged by the other or by
// frames of the same.
enum class JudgedBy { kOtherMotion, kOtherFrames };
Diagnosis DiagnoseSheet(const Eigen::Vector3d& gravity, JudgedBy judge = JudgedBy::kOtherMotion) {
  Recording fit = HungSheet(0), other = HungSheet(1);
  const SpringMassSystem system = SheetSystem(fit);
  MoveByMujoco(system, gravity, &fit);
  MoveByMujoco(system, gravity, &other);
  other.hash = "another";
  const Twin twin = TwinOf(system, fit);
  if (judge == JudgedBy::kOtherFrames) return Diagnose(twin, {.fit = {fit}}, OneEffect());
  return Diagnose(twin, {.fit = {fit}, .held_out = {other}}, OneEffect());
}

Eigen::Vector3d TiltedGravity(double tilt) {
  return 9.81 * Eigen::Vector3d(0, std::sin(tilt), -std::cos(tilt));
}

TEST(Diagnosis, FindsTiltedGravity) {
  constexpr double kTilt = 0.12;  // rad, about x
  const Diagnosis diagnosis = DiagnoseSheet(TiltedGravity(kTilt));
  ASSERT_EQ(diagnosis.effects.size(), 1U);
  EXPECT_EQ(diagnosis.effects[0].name, "gravity_direction");
  // 800 points with noise of 0.3 mm leave less than a tenth of the angle open
  EXPECT_NEAR(diagnosis.effects[0].values[0], kTilt, 0.1 * kTilt);
  EXPECT_NEAR(diagnosis.effects[0].values[1], 0, 0.1 * kTilt);
  ASSERT_EQ(diagnosis.certainty.size(), 2U);
  EXPECT_LT(diagnosis.certainty[0].error, 0.05 * kTilt);
  EXPECT_LT(std::abs(diagnosis.effects[0].values[0] - kTilt), 4 * diagnosis.certainty[0].error);
  EXPECT_LT(diagnosis.certainty[0].unknown, 0.01);
  EXPECT_EQ(diagnosis.twin.trained_on[0].train_frames, kFrames);  // all of them were fitted
  EXPECT_LT(diagnosis.after.held, 1.5 * diagnosis.noise_floor);
  EXPECT_GT(diagnosis.before.held, 3 * diagnosis.after.held);
  EXPECT_FALSE(diagnosis.unexplained);
  EXPECT_FALSE(diagnosis.all_frames);
  // the missing force says so, too
  const Eigen::Vector3d& missing = diagnosis.residual_before.acceleration;
  EXPECT_GT(missing[1], 3 * std::abs(missing[0]));
  EXPECT_LT(diagnosis.residual_after.root_mean_square,
            0.5 * diagnosis.residual_before.root_mean_square);
}

// As if another axis of the camera's frame pointed up.
TEST(Diagnosis, FindsGravityAQuarterTurnAway) {
  const Diagnosis diagnosis = DiagnoseSheet(TiltedGravity(std::numbers::pi / 2));
  ASSERT_EQ(diagnosis.effects.size(), 1U) << diagnosis.refusal;
  EXPECT_EQ(diagnosis.effects[0].name, "gravity_direction");
  EXPECT_NEAR(diagnosis.effects[0].values[0], std::numbers::pi / 2, 0.02);
  EXPECT_NEAR(diagnosis.effects[0].values[1], 0, 0.02);
  EXPECT_LT(diagnosis.after.held, 3 * diagnosis.noise_floor);
  EXPECT_GT(diagnosis.before.held, 10 * diagnosis.after.held);
}

TEST(Diagnosis, EndsWithAFitToAllFrames) {
  constexpr double kTilt = 0.12;
  const Diagnosis diagnosis = DiagnoseSheet(TiltedGravity(kTilt), JudgedBy::kOtherFrames);
  ASSERT_EQ(diagnosis.effects.size(), 1U);
  EXPECT_NEAR(diagnosis.effects[0].values[0], kTilt, 0.1 * kTilt);
  ASSERT_TRUE(diagnosis.all_frames);
  EXPECT_LT(*diagnosis.all_frames, 1.2 * diagnosis.noise_floor);
  EXPECT_EQ(diagnosis.twin.levels[0].system.effects.back().values, diagnosis.effects[0].values);
  EXPECT_EQ(diagnosis.twin.trained_on[0].train_frames, kFrames);
}

// The twin was trained before gravity turned, and not well.
TEST(Diagnosis, FindsWhatHasChangedOfATwinThatIsTooSoft) {
  constexpr double kTilt = 0.12, kSoft = 0.6;
  Recording before = HungSheet(2), after = HungSheet(0);
  const SpringMassSystem truth = SheetSystem(before);
  MoveByMujoco(truth, TiltedGravity(0), &before);
  MoveByMujoco(truth, TiltedGravity(kTilt), &after);
  after.hash = "another";
  Twin twin = TwinOf(truth, before);
  twin.levels[0].system.stiffness *= kSoft;
  const Diagnosis diagnosis = Diagnose(twin, {.fit = {after}, .before = {before}}, OneEffect());
  ASSERT_EQ(diagnosis.effects.size(), 1U) << diagnosis.refusal;
  EXPECT_EQ(diagnosis.effects[0].name, "gravity_direction");
  EXPECT_NEAR(diagnosis.effects[0].values[0], kTilt, 0.1 * kTilt);
  EXPECT_LT(diagnosis.after.held, 1.2 * diagnosis.noise_floor);
  EXPECT_EQ(diagnosis.before_change, std::vector<std::string>{"sheet"});
  const SpringMassSystem& found = diagnosis.twin.levels[0].system;
  EXPECT_NEAR(found.stiffness.mean() / truth.stiffness.mean(), 1, 0.1);
}

TEST(Diagnosis, FindsNothingWhereNothingIsMissing) {
  const Diagnosis diagnosis = DiagnoseSheet(Eigen::Vector3d(0, 0, -9.81));
  EXPECT_TRUE(diagnosis.effects.empty());
  // the twin came with the true parameters, which no refit to noisy data reaches
  EXPECT_LT(diagnosis.before.held, 1.05 * diagnosis.noise_floor);
  EXPECT_EQ(diagnosis.after.held, diagnosis.before.held);
  EXPECT_LE(diagnosis.residual_before.root_mean_square, 2 * diagnosis.residual_before.noise);
  EXPECT_FALSE(diagnosis.unexplained);
}

}  // namespace
}  // namespace physpring
