// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/two_stage.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/interrupted_work.h"
#include "tests/support/same_twin.h"
#include "tests/support/swung_rope.h"
#include "trainer/bodies/phystwin_variables.h"
#include "twin/error.h"
#include "twin/evaluate.h"

namespace physpring {
namespace {

constexpr int kGenerations = 20, kPopulation = 11;  // as published

TrainOptions Options(int epochs = 2) {
  TrainOptions options;
  options.method = TrainOptions::Method::kTwoStage;
  options.epochs = epochs;
  options.seed = 42;
  return options;
}

// Ropes moved by a model that the search can find.
FitData MovedByAModel(int frames, int recordings = 1) {
  FitData data;
  for (int i = 0; i < recordings; ++i) {
    Recording recording = SwungRope(8, frames + i);
    PhysTwinVariables variables = FromUnitCube(PhysTwinStart(), 2);
    variables.spring_y = 1e4;
    variables.drag = 9;
    variables.dashpot = 40;
    MoveAs(MakePhysTwinSystem(recording, variables, false), true, &recording);
    data.recordings.push_back(recording);
    data.continuous_recording.push_back(i);
  }
  return data;
}

Twin Fit(const FitData& data, const TrainOptions& options) {
  return RunToTheEnd([&](const Work& work) { return FitTwoStage(data, options, work); });
}

double TrackError(const Twin& twin, const Recording& recording) {
  const RecordingResult result = Evaluate(twin, recording, {});
  return *MeansOverFrames(result.levels[0].direct, 1, recording.frame_count()).track.value;
}

TEST(FitTwoStage, SpendsThePublishedBudget) {
  const FitData data = MovedByAModel(3);
  WorkLog log;
  RunLogged([&](const Work& work) { return FitTwoStage(data, Options(3), work); }, &log);
  EXPECT_EQ(log.parts["search"], kGenerations * kPopulation);
  EXPECT_EQ(log.parts["single springs"], 3);
  EXPECT_TRUE(std::is_sorted(log.shares.begin(), log.shares.end()));
  EXPECT_NEAR(log.shares.back(), 1, 1e-9);
}

TEST(FitTwoStage, ExplainsWhatAModelOfItsKindDid) {
  const FitData data = MovedByAModel(20);
  WorkLog log;
  const Twin twin =
      RunLogged([&](const Work& work) { return FitTwoStage(data, Options(20), work); }, &log);
  const double at_start = TrackError(log.reached[0], data.recordings[0]);
  EXPECT_LT(TrackError(twin, data.recordings[0]), 0.25 * at_start);
  EXPECT_EQ(twin.points, 8);
  EXPECT_EQ(twin.levels[0].system.controllers, 1);
}

TEST(FitTwoStage, GivesTheSameBitsForAnyNumberOfThreads) {
  const FitData data = MovedByAModel(3, 2);
  TrainOptions options = Options();
  const Twin one = Fit(data, options);
  options.threads = 3;
  ExpectSameTwin(Fit(data, options), one);
}

TEST(FitTwoStage, StoppedAnywhereGivesTheSameBits) {
  const FitData data = MovedByAModel(3);
  const auto fit = [&](const Work& work) { return FitTwoStage(data, Options(), work); };
  int stops = 0;
  ExpectSameTwin(RunStopped(fit, 7, &stops), RunToTheEnd(fit));
  EXPECT_EQ(stops, (kGenerations * kPopulation + 1) / 7);
}

TEST(FitTwoStage, DependsOnTheSeed) {
  const FitData data = MovedByAModel(3);
  TrainOptions options = Options();
  const auto stiffness = [&] {
    const Twin twin = Fit(data, options);
    const Eigen::VectorXd& k = twin.levels[0].system.stiffness;
    return std::vector<double>(k.begin(), k.end());
  };
  const std::vector<double> one = stiffness();
  options.seed = 43;
  EXPECT_NE(stiffness(), one);
}

TEST(FitTwoStage, HasATwinToShowFromTheStartOn) {
  const FitData data = MovedByAModel(3);
  WorkLog log;
  RunLogged([&](const Work& work) { return FitTwoStage(data, Options(), work); }, &log);
  ASSERT_EQ(log.reached.size(), 2u);
  for (const Twin& twin : log.reached) {
    ASSERT_NO_THROW(twin.levels.at(0).system.Validate("twin"));
    ASSERT_GE(twin.levels[0].substeps_per_second, 50);
  }
}

TEST(FitTwoStage, TakesTheSubstepsGiven) {
  TrainOptions options = Options(1);
  options.substeps = 667;
  EXPECT_EQ(Fit(MovedByAModel(2), options).levels[0].substeps_per_second, 667 * 50);
}

TEST(FitTwoStage, SaysThatTooFewSubstepsWereGiven) {
  TrainOptions options = Options();
  options.substeps = 1;
  try {
    Fit(MovedByAModel(20), options);
    ADD_FAILURE() << "one sub-step a frame went well";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "recording rope: the motion diverges with every start value tried; 1 sub-steps "
                 "a frame are too few");
  }
}

TEST(FitTwoStage, RefusesControllersThatAreAllOutOfReach) {
  FitData data = MovedByAModel(3);
  Recording& recording = data.recordings[0];
  recording.rest.col(8) = recording.rest.col(0) + Eigen::Vector3d(0, 0, 1);
  try {
    Fit(data, Options());
    ADD_FAILURE() << "a controller was joined over 1 m";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "recording rope: no controller is near enough to a particle to move it; "
                 "PhysTwin's search joins them up to 0.166 m apart, --method full at any distance");
  }
}

}  // namespace
}  // namespace physpring
