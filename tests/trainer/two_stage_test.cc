// SPDX-License-Identifier: Apache-2.0
#include "trainer/two_stage.h"

#include <gtest/gtest.h>

#include "tests/support/swung_rope.h"
#include "trainer/make_fitter.h"
#include "trainer/phystwin_variables.h"
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

int RunToTheEnd(Fitter* fit) {
  int steps = 0;
  while (fit->Step()) ++steps;
  return steps;
}

bool SameBits(const StateArrays& a, const StateArrays& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](auto& x, auto& y) {
           return x.first == y.first && x.second.data == y.second.data;
         });
}

double TrackError(const Twin& twin, const Recording& recording) {
  const RecordingResult result = Evaluate(twin, recording, {});
  return *MeansOverFrames(result.levels[0].direct, 1, recording.frame_count()).track.value;
}

TEST(TwoStageFit, SpendsThePublishedBudget) {
  const auto fit = MakeFitter(MovedByAModel(3), Options(3));
  EXPECT_EQ(RunToTheEnd(fit.get()), kGenerations * kPopulation + 3);
  EXPECT_EQ(fit->Progress(), 1);
}

TEST(TwoStageFit, ExplainsWhatAModelOfItsKindDid) {
  const FitData data = MovedByAModel(20);
  TwoStageFit fit(data, Options(20));
  const double at_start = TrackError(fit.Result(), data.recordings[0]);
  RunToTheEnd(&fit);
  const Twin twin = fit.Result();
  EXPECT_LT(TrackError(twin, data.recordings[0]), 0.25 * at_start);
  EXPECT_EQ(twin.points, 8);
  EXPECT_EQ(twin.levels[0].system.controllers, 1);
}

TEST(TwoStageFit, GivesTheSameBitsForAnyNumberOfThreads) {
  TrainOptions options = Options();
  TwoStageFit one(MovedByAModel(3, 2), options);
  options.threads = 3;
  TwoStageFit three(MovedByAModel(3, 2), options);
  RunToTheEnd(&one);
  RunToTheEnd(&three);
  EXPECT_TRUE(SameBits(one.Save(), three.Save()));
  EXPECT_EQ(one.Result().levels[0].system.stiffness, three.Result().levels[0].system.stiffness);
}

TEST(TwoStageFit, ResumesFromAnyStep) {
  const FitData data = MovedByAModel(3);
  TwoStageFit whole(data, Options());
  std::unique_ptr<TwoStageFit> stopped = std::make_unique<TwoStageFit>(data, Options());
  for (int step = 1; whole.Step(); ++step) {
    // go on with what a new fit makes of the state
    if (step % 7 == 0 || step > kGenerations * kPopulation - 2) {
      const StateArrays state = stopped->Save();
      stopped = std::make_unique<TwoStageFit>(data, Options());
      stopped->Load(state);
      ASSERT_TRUE(SameBits(stopped->Save(), state)) << step;
    }
    stopped->Step();
    ASSERT_TRUE(SameBits(whole.Save(), stopped->Save())) << step;
  }
  EXPECT_FALSE(stopped->Step());
}

TEST(TwoStageFit, DependsOnTheSeed) {
  TrainOptions options = Options();
  TwoStageFit one(MovedByAModel(3), options);
  options.seed = 43;
  TwoStageFit other(MovedByAModel(3), options);
  for (int i = 0; i < kPopulation; ++i) {
    one.Step();
    other.Step();
  }
  EXPECT_FALSE(SameBits(one.Save(), other.Save()));
}

TEST(TwoStageFit, AlwaysHasATwinToShow) {
  TwoStageFit fit(MovedByAModel(3), Options());
  do {
    const Twin twin = fit.Result();
    ASSERT_NO_THROW(twin.levels.at(0).system.Validate("twin"));
    ASSERT_GE(twin.levels[0].substeps_per_second, 50);
  } while (fit.Step());
}

TEST(TwoStageFit, TakesTheSubstepsGiven) {
  TrainOptions options = Options(1);
  options.substeps = 667;
  TwoStageFit fit(MovedByAModel(2), options);
  EXPECT_EQ(fit.Result().levels[0].substeps_per_second, 667 * 50);
}

TEST(TwoStageFit, SaysThatTooFewSubstepsWereGiven) {
  TrainOptions options = Options();
  options.substeps = 1;
  TwoStageFit fit(MovedByAModel(20), options);
  try {
    RunToTheEnd(&fit);
    ADD_FAILURE() << "one sub-step a frame went well";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "recording rope: the motion diverges with every start value tried; 1 sub-steps "
                 "a frame are too few");
  }
}

TEST(TwoStageFit, RefusesControllersThatAreAllOutOfReach) {
  FitData data = MovedByAModel(3);
  Recording& recording = data.recordings[0];
  recording.rest.col(8) = recording.rest.col(0) + Eigen::Vector3d(0, 0, 1);
  try {
    TwoStageFit fit(data, Options());
    ADD_FAILURE() << "a controller was joined over 1 m";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "recording rope: no controller is near enough to a particle to move it; "
                 "PhysTwin's search joins them up to 0.166 m apart, --method full at any distance");
  }
}

TEST(TwoStageFit, RefusesTheStateOfAnotherFit) {
  TwoStageFit fit(MovedByAModel(3), Options());
  StateArrays state = fit.Save();
  state.erase("train/search_mean");
  EXPECT_THROW(fit.Load(state), Error);
  state = fit.Save();
  state["train/search_covariance"] = StoreVector(Eigen::Vector3d::Zero());
  EXPECT_THROW(fit.Load(state), Error);
}

}  // namespace
}  // namespace physpring
