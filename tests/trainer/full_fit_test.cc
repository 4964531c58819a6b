// SPDX-License-Identifier: Apache-2.0
#include "trainer/full_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "tests/support/swung_rope.h"
#include "trainer/fit_model.h"
#include "trainer/start_system.h"
#include "trainer/state_arrays.h"
#include "twin/error.h"
#include "twin/evaluate.h"

namespace physpring {
namespace {

constexpr int kParticles = 12, kFrames = 16;

TrainOptions Options() {
  TrainOptions options;
  options.neighbours = {6};
  options.epochs = 3;
  return options;
}

// A rope that moves as a system of the fit's kind does, its springs unequal.
FitData Swung(int recordings = 1, const std::vector<EffectValues>& effects = {}) {
  FitData data;
  for (int i = 0; i < recordings; ++i) {
    Recording recording = SwungRope(kParticles, kFrames - i);
    SpringMassSystem system =
        MakeStartSystem(recording, {.max_neighbours = 6, .controller_max_neighbours = 6});
    ScaleToSubsteps(1 / recording.fps, 12, 0.7, &system);
    for (int e = 0; e < system.spring_count(); ++e) system.stiffness[e] *= 0.7 + 0.1 * (e % 4);
    system.effects = effects;
    MoveAs(system, true, &recording);
    data.recordings.push_back(std::move(recording));
    data.continuous_recording.push_back(i);
  }
  return data;
}

int RunToTheEnd(FullFit* fit) {
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

// Mean distance of the points from where they are in frame 0, m.
double MotionlessError(const Recording& recording) {
  double sum = 0;
  for (int t = 1; t < recording.frame_count(); ++t) {
    sum += (recording.points[t] - recording.points[0]).colwise().norm().mean();
  }
  return sum / (recording.frame_count() - 1);
}

TEST(FullFit, ExplainsWhatASystemOfItsKindDid) {
  const FitData data = Swung();
  FullFit fit(data, Options());
  RunToTheEnd(&fit);
  const Twin twin = fit.Result();
  EXPECT_LT(TrackError(twin, data.recordings[0]), 0.03 * MotionlessError(data.recordings[0]));
  EXPECT_EQ(fit.Progress(), 1);
  EXPECT_EQ(twin.points, kParticles);
  EXPECT_EQ(twin.levels[0].system.controllers, 1);
  EXPECT_NO_THROW(twin.levels[0].system.Validate("twin"));
}

TEST(FullFit, KeepsTheEffectsThatItIsGiven) {
  const std::vector<EffectValues> wind = {{"air_drag", Eigen::Vector4d(0.02, 3, 0, 0)}};
  const FitData data = Swung(1, wind);
  TrainOptions options = Options();
  const auto error = [&] {
    FullFit fit(data, options);
    RunToTheEnd(&fit);
    const Twin twin = fit.Result();
    EXPECT_EQ(twin.levels[0].system.effects.size(), options.effects.size());
    return TrackError(twin, data.recordings[0]);
  };
  const double without = error();
  options.effects = wind;
  EXPECT_LT(error(), 0.5 * without);
}

TEST(FullFit, ProgressNeverFalls) {
  FullFit fit(Swung(), Options());
  double last = fit.Progress();
  while (fit.Step()) {
    ASSERT_GE(fit.Progress(), last) << fit.Status();
    ASSERT_LE(fit.Progress(), 1) << fit.Status();
    last = fit.Progress();
  }
}

TEST(FullFit, ResumesFromAnyStep) {
  const FitData data = Swung();
  FullFit whole(data, Options());
  auto stopped = std::make_unique<FullFit>(data, Options());
  for (int step = 1; whole.Step(); ++step) {
    const StateArrays state = stopped->Save();
    stopped = std::make_unique<FullFit>(data, Options());
    stopped->Load(state);
    ASSERT_TRUE(SameBits(stopped->Save(), state)) << step;
    ASSERT_TRUE(stopped->Step());
    ASSERT_TRUE(SameBits(whole.Save(), stopped->Save())) << step;
  }
  EXPECT_FALSE(stopped->Step());
  EXPECT_EQ(whole.Result().levels[0].system.stiffness,
            stopped->Result().levels[0].system.stiffness);
}

// What moved as a chain that bends gets one, whose fit ends with free motions.
TEST(FullFit, ResumesTheFitOfAChain) {
  Recording recording = SwungRope(8, kFrames);
  recording.order = Eigen::VectorXd::LinSpaced(recording.rest.cols(), 0.08, 0);
  MoveAs(StartSystem(recording, Candidates(recording, {}).back(), 8), true, &recording);
  FitData data;
  data.recordings.push_back(recording);
  data.continuous_recording.push_back(0);
  TrainOptions options;
  options.epochs = 3;
  FullFit whole(data, options);
  auto stopped = std::make_unique<FullFit>(data, options);
  int searched = 0, descended = 0;
  for (double last = 0; whole.Step(); last = whole.Progress()) {
    searched += whole.Part() == "search among free motions" ? 1 : 0;
    descended += whole.Part() == "descent of free motions" ? 1 : 0;
    ASSERT_GE(whole.Progress(), last);
    const StateArrays state = stopped->Save();
    stopped = std::make_unique<FullFit>(data, options);
    stopped->Load(state);
    ASSERT_TRUE(SameBits(stopped->Save(), state));
    ASSERT_TRUE(stopped->Step());
    ASSERT_TRUE(SameBits(whole.Save(), stopped->Save()));
  }
  EXPECT_EQ(searched, options.epochs);
  EXPECT_GE(descended, 1);
  EXPECT_LT(TrackError(whole.Result(), recording), 0.05 * MotionlessError(recording));
}

TEST(FullFit, GivesTheSameBitsForAnyNumberOfThreads) {
  const FitData data = Swung(2);
  TrainOptions options = Options();
  FullFit one(data, options);
  options.threads = 2;
  FullFit two(data, options);
  RunToTheEnd(&one);
  RunToTheEnd(&two);
  EXPECT_TRUE(SameBits(one.Save(), two.Save()));
}

TEST(FullFit, OptimizerIsTheOneAskedFor) {
  TrainOptions options = Options();
  const FitData data = Swung();
  for (const auto optimizer :
       {TrainOptions::Optimizer::kGaussNewton, TrainOptions::Optimizer::kAdam}) {
    options.optimizer = optimizer;
    FullFit fit(data, options);
    RunToTheEnd(&fit);
    const bool adam = optimizer == TrainOptions::Optimizer::kAdam;
    EXPECT_EQ(fit.Save().at("train/adam_mean").ToDoubles().empty(), !adam);
    EXPECT_LT(TrackError(fit.Result(), data.recordings[0]),
              0.1 * MotionlessError(data.recordings[0]));
  }
}

TEST(FullFit, SaysThatTooFewSubstepsWereGiven) {
  FitData data = Swung();
  data.recordings[0] = SwungRope(kParticles, 400);
  TrainOptions options = Options();
  options.substeps = 1;
  FullFit fit(data, options);
  try {
    RunToTheEnd(&fit);
    ADD_FAILURE() << "one sub-step a frame went well";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "recording rope: the motion diverges with every start value tried; 1 sub-steps "
                 "a frame are too few");
  }
}

TEST(FullFit, RefusesTheStateOfAnotherFit) {
  FullFit fit(Swung(), Options());
  StateArrays state = fit.Save();
  state.erase("train/factors");
  EXPECT_THROW(fit.Load(state), Error);
  state = fit.Save();
  state["train/contenders"] = StoreVector(Eigen::Vector3d::Zero());
  EXPECT_THROW(fit.Load(state), Error);
}

}  // namespace
}  // namespace physpring
