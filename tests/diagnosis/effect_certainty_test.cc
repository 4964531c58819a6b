// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/effect_certainty.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/random_system.h"
#include "tests/support/swung_rope.h"
#include "trainer/bodies/start_system.h"

namespace physpring {
namespace {

constexpr int kRows = 4000;

Eigen::VectorXd RandomRows(std::uint64_t seed) {
  Random random(seed);
  Eigen::VectorXd rows(kRows);
  for (double& value : rows) value = random(-1, 1);
  return rows;
}

Eigen::MatrixXd Prior(int entries) {
  return kDiagnosisPrecision * Eigen::MatrixXd::Identity(entries, entries);
}

TEST(CertaintyFrom, HasTheErrorOfAMeanOfIndependentResiduals) {
  const Eigen::VectorXd r = RandomRows(1);
  const auto certainty = CertaintyFrom(Eigen::MatrixXd::Ones(kRows, 1), r, Prior(1), 0);
  ASSERT_EQ(certainty.size(), 1U);
  const double expected = std::sqrt(r.squaredNorm() / kRows / kRows);
  EXPECT_GE(certainty[0].error, 0.99 * expected);
  // the scatter of 20 stretches has a relative standard deviation of 1 / sqrt(2 * 19)
  EXPECT_LE(certainty[0].error, (1 + 3 / std::sqrt(38.0)) * expected);
  EXPECT_NEAR(certainty[0].shared, 0, 1e-6);
}

TEST(CertaintyFrom, WidensWhereNeighboursAreAlike) {
  Eigen::VectorXd r = RandomRows(1);
  // each tenth of a stretch is one value: as many draws fewer
  constexpr int kAlike = kRows / 200;
  for (int i = 0; i < kRows; ++i) r[i] = r[i - i % kAlike];
  const auto certainty = CertaintyFrom(Eigen::MatrixXd::Ones(kRows, 1), r, Prior(1), 0);
  const double independent = std::sqrt(r.squaredNorm() / kRows / kRows);
  EXPECT_NEAR(certainty[0].error / (std::sqrt(kAlike) * independent), 1, 3 / std::sqrt(38.0));
}

TEST(CertaintyFrom, SaysWhatOthersCouldDoAsWell) {
  Eigen::MatrixXd jacobian(kRows, 3);
  jacobian << RandomRows(1), RandomRows(1) + 0.1 * RandomRows(2), RandomRows(3);
  const auto certainty = CertaintyFrom(jacobian, RandomRows(4), Prior(3), 1);
  ASSERT_EQ(certainty.size(), 2U);                    // the first entry is not asked for
  EXPECT_NEAR(certainty[0].shared, 1 / 1.01, 0.002);  // squared correlation of the two
  EXPECT_LT(certainty[1].shared, 0.01);
}

TEST(CertaintyFrom, SaysWhatTheRecordingsSayNothingAbout) {
  Eigen::MatrixXd jacobian(kRows, 2);
  jacobian << RandomRows(1), Eigen::VectorXd::Zero(kRows);
  const auto certainty = CertaintyFrom(jacobian, RandomRows(2), Prior(2), 0);
  EXPECT_LT(certainty[0].unknown, 0.01);
  EXPECT_NEAR(certainty[1].unknown, 1, 1e-9);
}

TEST(CertaintyOf, IsOfAllEffectsValues) {
  constexpr int kFrames = 40;
  Recording recording = SwungRope(6, kFrames);
  recording.train_frames = kFrames;
  const SpringMassSystem system = MakeStartSystem(recording, {});
  MoveAs(system, true, &recording);
  Random random(1);
  for (Points& points : recording.points) points += random.Box(points.cols(), 1e-3);
  const Fitting fitting({{system, true, DiagnosisBody::Kind::kTrusted, "rope"}},
                        {UseAll(recording, SplitRecording::Use::kFit)}, 1);
  const Descent descent = fitting.Begin(0, {{"gravity_direction", Eigen::Vector2d::Zero()},
                                            {"tension_only", Eigen::VectorXd::Zero(1)}});
  const auto certainty = CertaintyOf(fitting, descent);
  ASSERT_EQ(certainty.size(), 3U);
  for (int i : {0, 1}) {
    EXPECT_GT(certainty[i].error, 1e-5);  // rad; noise of 1 mm over 240 points
    EXPECT_LT(certainty[i].error, 0.05);
  }
}

}  // namespace
}  // namespace physpring
