// SPDX-License-Identifier: Apache-2.0
#include "twin/predict.h"

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>

#include "tests/support/small_twin.h"
#include "twin/error.h"
#include "twin/hierarchy.h"
#include "twin/stability.h"

namespace physpring {
namespace {

std::string ErrorOf(const Twin& twin, int level, const Recording& recording,
                    const PredictOptions& options = {}) {
  try {
    Predict(twin, level, recording, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

void ExpectMentions(const std::string& text, std::initializer_list<const char*> parts) {
  for (const char* part : parts) EXPECT_NE(text.find(part), std::string::npos) << text;
}

// Free particles and no force but gravity.
Twin FreeParticles() {
  Twin twin = SmallTwin(1);
  SpringMassSystem& system = twin.levels[0].system;
  system.springs.clear();
  system.stiffness.resize(0);
  system.rest_length.resize(0);
  system.dashpot.resize(0);
  system.drag = 0;
  return twin;
}

TEST(Predict, FollowsTheRecordingsStartVelocityAndGravity) {
  const Twin twin = FreeParticles();
  Recording recording = RecordingOfMotion(twin, 6);
  recording.gravity = {0, 2, 0};
  recording.start.row(0).array() += 1;
  recording.velocity.row(2).array() += 0.5;
  const std::vector<Points> motion = Predict(twin, 0, recording, {.substeps = 10});

  // semi-implicit Euler of a free fall, exactly: x = x0 + v0 t + g h^2 n (n + 1) / 2
  const double h = 1 / recording.fps / 10;
  const double n = 50;
  const Eigen::Vector3d expected =
      recording.start.col(7) + Eigen::Vector3d(0, 2 * h * h * n * (n + 1) / 2, 0.5 * n * h);
  ASSERT_EQ(motion.size(), 6u);
  EXPECT_LT((motion[5].col(7) - expected).norm(), 1e-14);
}

TEST(Predict, KeepsRestLengthsWhenTheRecordingStartsStretched) {
  const Twin twin = SmallTwin(1);
  Recording recording = RecordingOfMotion(twin, 2);
  recording.gravity.setZero();
  recording.start *= 1.1;
  for (Points& controllers : recording.controllers) controllers = recording.start.rightCols(2);
  const std::vector<Points> motion = Predict(twin, 0, recording, {});
  const auto width = [](const Points& points) {
    return points.row(0).maxCoeff() - points.row(0).minCoeff();
  };
  EXPECT_LT(width(motion[1]), width(motion[0]));
}

TEST(Predict, StartsCoarseLevelsAtTheMeansOfTheirMembers) {
  const Twin twin = SmallTwin(3);
  const Recording recording = RecordingOfMotion(twin, 3);
  const Eigen::VectorXd& mass = twin.levels[0].system.mass;
  const Points level2 = Predict(twin, 2, recording, {})[0];
  ASSERT_EQ(level2.cols(), 10);
  // node 0: particles (0, 0, z) and (0, 1, z)
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double total = 0;
  for (int i : {0, 5, 20, 25}) {
    sum += mass[i] * recording.start.col(i);
    total += mass[i];
  }
  EXPECT_LT((level2.col(0) - sum / total).norm(), 1e-15);
}

TEST(Predict, AgreesInSinglePrecision) {
  const Twin twin = SmallTwin(1);
  const Recording recording = RecordingOfMotion(twin, 20);
  const Points exact = Predict(twin, 0, recording, {})[19];
  const Points single = Predict(twin, 0, recording, {.single_precision = true})[19];
  const double difference = (exact - single).cwiseAbs().maxCoeff();
  EXPECT_GT(difference, 0);
  EXPECT_LT(difference, 1e-4);  // 1 um a second of round-off would be far too much
}

TEST(Predict, NamesBothNumbersOfAnotherObject) {
  const Twin twin = SmallTwin(1);
  const Recording recording = RecordingOfMotion(twin, 3);
  Recording more_points = recording;
  more_points.points.assign(3, Points::Zero(3, 33));
  ExpectMentions(ErrorOf(twin, 0, more_points), {"33 points", "has 32"});
  Recording no_interior = recording;
  no_interior.interior.resize(3, 0);
  ExpectMentions(ErrorOf(twin, 0, no_interior), {"0 interior particles", "has 8"});
  Recording no_controllers = recording;
  no_controllers.controllers.clear();
  ExpectMentions(ErrorOf(twin, 0, no_controllers), {"0 controllers", "has 2"});
}

TEST(Predict, SaysWhereItDiverges) {
  Twin twin = SmallTwin(1);
  const Recording recording = RecordingOfMotion(twin, 40);
  twin.levels[0].system.stiffness *= 1e4;
  ExpectMentions(ErrorOf(twin, 0, recording, {.substeps = 1}),
                 {"diverges in frame", "with 1 sub-steps"});
}

TEST(Predict, RefusesALevelThatIsNotThere) {
  const Twin twin = SmallTwin(2);
  ExpectMentions(ErrorOf(twin, 2, RecordingOfMotion(twin, 3)), {"no level 2", "0 to 1"});
}

TEST(ChooseSubsteps, KeepsTheSubStepOfTraining) {
  TwinLevel level = SmallTwin(1).levels[0];
  level.substeps_per_second = 6000;
  EXPECT_EQ(ChooseSubsteps(level, 50, 0), 120);
  EXPECT_EQ(ChooseSubsteps(level, 49, 0), 123);  // 122.4
  EXPECT_EQ(ChooseSubsteps(level, 50, 7), 7);
}

TEST(ChooseSubsteps, StaysBelowTheStableSubStep) {
  TwinLevel level = SmallTwin(1).levels[0];
  level.substeps_per_second = 1;
  const double stable = ComputeStabilityBound(level.system).timestep;
  const double substep = 1.0 / 50 / ChooseSubsteps(level, 50, 0);
  EXPECT_LE(substep, kStepSafety * stable);
  EXPECT_GT(substep, 0.6 * kStepSafety * stable);  // whole sub-steps in a frame
}

}  // namespace
}  // namespace physpring
