// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/dense_fit.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/interrupted_work.h"
#include "tests/support/same_twin.h"
#include "tests/support/swung_rope.h"
#include "trainer/bodies/candidates.h"
#include "trainer/bodies/start_system.h"
#include "trainer/fits/net_fit.h"
#include "twin/error.h"
#include "twin/evaluate.h"
#include "twin/topology.h"

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

Twin Fit(const FitData& data, const TrainOptions& options) {
  return RunToTheEnd([&](const Work& work) { return FitDense(data, options, work); });
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

TEST(FitDense, ExplainsWhatASystemOfItsKindDid) {
  const FitData data = Swung();
  const Twin twin = Fit(data, Options());
  EXPECT_LT(TrackError(twin, data.recordings[0]), 0.03 * MotionlessError(data.recordings[0]));
  EXPECT_EQ(twin.points, kParticles);
  EXPECT_EQ(twin.levels[0].system.controllers, 1);
  EXPECT_NO_THROW(twin.levels[0].system.Validate("twin"));
}

// A rope whose springs have one axial stiffness and one loss time, measured with noise; and its
// true springs.
struct SmoothRope {
  FitData data;
  SpringMassSystem truth;
};

SmoothRope MakeSmoothRope(bool controller_velocity = true, double loss_time = 2e-3) {
  SmoothRope rope;
  Recording recording = SwungRope(kParticles, 40);
  rope.truth = MakeStartSystem(recording, {.max_neighbours = 6, .controller_max_neighbours = 6});
  ScaleToSubsteps(1 / recording.fps, 12, 0.7, &rope.truth);
  rope.truth.dashpot = loss_time * rope.truth.stiffness;
  MoveAs(rope.truth, controller_velocity, &recording);
  rope.data.recordings.push_back(recording);
  rope.data.continuous_recording.push_back(0);
  return rope;
}

TrainOptions OptionsOfSmoothRope(TrainOptions::Method method) {
  TrainOptions options = Options();
  options.epochs = 0;
  options.method = method;
  options.controller_velocity = true;
  return options;
}

TEST(FitDense, FindsTheMaterialOfASmoothBody) {
  const auto [data, truth] = MakeSmoothRope();
  const SpringMassSystem found =
      Fit(data, OptionsOfSmoothRope(TrainOptions::Method::kSmooth)).levels[0].system;
  ASSERT_EQ(found.springs, truth.springs);
  EXPECT_EQ(found.rest_length, truth.rest_length);  // no spring has a value of its own
  const Eigen::VectorXd ratio = found.stiffness.cwiseQuotient(truth.stiffness);
  std::vector<double> ratios(ratio.begin(), ratio.end());
  std::nth_element(ratios.begin(), ratios.begin() + ratios.size() / 2, ratios.end());
  EXPECT_NEAR(ratios[ratios.size() / 2], 1, 0.05);
  EXPECT_NEAR(found.drag, truth.drag, 0.02 * truth.drag);
}

// What is left of a body that the smooth one can be is noise, so it gets no single springs.
TEST(FitDense, SmoothBodyStaysWhereItLeavesNoise) {
  SmoothRope rope = MakeSmoothRope();
  AddNoise(&rope.data.recordings[0], 5);
  const auto fit = [&](TrainOptions::Method method, WorkLog* log) {
    return RunLogged(
        [&](const Work& work) { return FitDense(rope.data, OptionsOfSmoothRope(method), work); },
        log);
  };
  WorkLog smooth, full;
  ExpectSameTwin(fit(TrainOptions::Method::kFull, &full),
                 fit(TrainOptions::Method::kSmooth, &smooth));
  EXPECT_EQ(full.parts.count("trial, single springs"), 0u);
}

TEST(FitDense, FindsWhetherDashpotsFeelTheControllers) {
  for (const bool felt : {true, false}) {
    SmoothRope rope = MakeSmoothRope(felt, 8e-3);
    AddNoise(&rope.data.recordings[0], 5);
    for (const bool smooth : {true, false}) {
      TrainOptions options = OptionsOfSmoothRope(TrainOptions::Method::kFull);
      options.controller_velocity = {};
      if (!smooth) options.epochs = 2;
      EXPECT_EQ(Fit(rope.data, options).controller_velocity, felt) << smooth;
    }
  }
}

bool Holds(const Estimate& estimate, double truth) {
  return estimate.low <= truth && truth <= estimate.high;
}

// The intervals hold the truth and are of some use; four times the noise makes them wider.
TEST(FitDense, SaysWhatTheMaterialIs) {
  SmoothRope rope = MakeSmoothRope();
  AddNoise(&rope.data.recordings[0], 5);
  const auto material = [&] {
    return *Fit(rope.data, OptionsOfSmoothRope(TrainOptions::Method::kSmooth)).material;
  };
  const Material found = material();
  ASSERT_FALSE(found.classes.empty());
  const double axial_stiffness = rope.truth.stiffness[0] * rope.truth.rest_length[0];
  for (const auto& one : found.classes) {
    EXPECT_TRUE(Holds(one.axial_stiffness, axial_stiffness)) << one.shortest;
  }
  EXPECT_TRUE(Holds(found.loss_time, 2e-3));
  EXPECT_TRUE(Holds(found.drag, rope.truth.drag));
  EXPECT_TRUE(found.loss_time.IsTold());
  for (int i = 0; i < 15; ++i) AddNoise(&rope.data.recordings[0], i);
  EXPECT_GT(material().loss_time.high / material().loss_time.value,
            found.loss_time.high / found.loss_time.value);
}

// Twins that are drawn differ, and predict about as well: what is left open hardly shows.
TEST(FitDense, LeavesOpenWhatHardlyShows) {
  SmoothRope rope = MakeSmoothRope();
  AddNoise(&rope.data.recordings[0], 5);
  const Twin twin = Fit(rope.data, OptionsOfSmoothRope(TrainOptions::Method::kSmooth));
  ASSERT_FALSE(twin.posterior.empty());
  const double fitted = TrackError(twin, rope.data.recordings[0]);
  for (int i = 0; i < 12; ++i) {
    const Twin sample = SampleOf(twin, 1, i);
    EXPECT_NE(sample.levels[0].system.stiffness, twin.levels[0].system.stiffness);
    EXPECT_LT(TrackError(sample, rope.data.recordings[0]), 1.5 * fitted) << i;
  }
}

// A rope that nothing moves does not tell how lossy it is.
TEST(FitDense, SaysWhatARecordingDoesNotTell) {
  SmoothRope rope = MakeSmoothRope();
  Recording& recording = rope.data.recordings[0];
  recording.gravity.setZero();
  for (std::size_t frame = 1; frame < recording.points.size(); ++frame) {
    recording.points[frame] = recording.points[0];
    recording.controllers[frame] = recording.controllers[0];
  }
  AddNoise(&recording, 5);
  const Material found =
      *Fit(rope.data, OptionsOfSmoothRope(TrainOptions::Method::kSmooth)).material;
  EXPECT_FALSE(found.loss_time.IsTold());
  EXPECT_FALSE(found.drag.IsTold());
}

// Springs that differ from each other without any order are no smooth body.
TEST(FitDense, SingleSpringsWhereTheyPredictBetter) {
  const FitData data = Swung(2);
  TrainOptions options = Options();
  options.epochs = 0;
  options.controller_velocity = true;
  WorkLog log;
  const auto fit = [&](const Work& work) { return FitDense(data, options, work); };
  const Twin twin = RunLogged(fit, &log);
  EXPECT_GT(log.parts["trial, smooth body"], 0);
  EXPECT_TRUE(std::is_sorted(log.shares.begin(), log.shares.end()));
  EXPECT_NE(twin.levels[0].system.rest_length,
            SpringLengths(twin.levels[0].system.springs, data.recordings[0].rest,
                          data.recordings[0].rod));
  int stops = 0;
  ExpectSameTwin(RunStopped(fit, 3, &stops), twin);
  EXPECT_GT(stops, 5);
}

TEST(FitDense, TriesSingleValuesOfFewParticlesInFewFrames) {
  FitData data = Swung();
  data.recordings[0].points[0] = Points::Zero(3, 1000);
  data.recordings[0].train_frames = 101;
  TrainOptions options;
  EXPECT_FALSE(LeavesOutSingleValues(data, options));
  data.recordings[0].train_frames = 102;
  EXPECT_TRUE(LeavesOutSingleValues(data, options));
  options.epochs = 3;  // asks for single springs
  EXPECT_FALSE(LeavesOutSingleValues(data, options));
}

TEST(FitDense, KeepsTheEffectsThatItIsGiven) {
  const std::vector<EffectValues> wind = {{"air_drag", Eigen::Vector4d(0.02, 3, 0, 0)}};
  const FitData data = Swung(1, wind);
  TrainOptions options = Options();
  const auto error = [&] {
    const Twin twin = Fit(data, options);
    EXPECT_EQ(twin.levels[0].system.effects.size(), options.effects.size());
    return TrackError(twin, data.recordings[0]);
  };
  const double without = error();
  options.effects = wind;
  EXPECT_LT(error(), 0.5 * without);
}

TEST(FitDense, TellsHowFarItIs) {
  const FitData data = Swung();
  WorkLog log;
  RunLogged([&](const Work& work) { return FitDense(data, Options(), work); }, &log);
  EXPECT_TRUE(std::is_sorted(log.shares.begin(), log.shares.end()));
  EXPECT_GT(log.shares.front(), 0);
  EXPECT_LE(log.shares.back(), 1);
  EXPECT_GT(log.parts["choosing the model"], 0);
  EXPECT_GT(log.parts["single springs (Gauss-Newton)"], 0);
  EXPECT_GT(log.parts["posterior"], 0);
  ASSERT_EQ(log.reached.size(), 3u);  // the softest, the chosen and the fitted one
  for (const Twin& twin : log.reached) EXPECT_NO_THROW(twin.levels[0].system.Validate("twin"));
}

TEST(FitDense, StoppedAnywhereGivesTheSameBits) {
  const FitData data = Swung();
  const auto fit = [&](const Work& work) { return FitDense(data, Options(), work); };
  const Twin whole = RunToTheEnd(fit);
  int stops = 0;
  ExpectSameTwin(RunStopped(fit, 1, &stops), whole);
  EXPECT_GT(stops, 20);
}

// What moved as a chain that bends gets one, whose fit ends with free motions.
TEST(FitDense, FitsAChainStoppedOrNot) {
  Recording recording = SwungRope(8, kFrames);
  recording.rod = PlainRod(Eigen::VectorXd::LinSpaced(recording.rest.cols(), 0.08, 0));
  MoveAs(StartSystem(recording, CandidateBodies(recording, {}).back(), 8), true, &recording);
  FitData data;
  data.recordings.push_back(recording);
  data.continuous_recording.push_back(0);
  TrainOptions options;
  options.epochs = 3;
  const auto fit = [&](const Work& work) { return FitDense(data, options, work); };
  WorkLog log;
  const Twin whole = RunLogged(fit, &log);
  EXPECT_TRUE(std::is_sorted(log.shares.begin(), log.shares.end()));
  EXPECT_EQ(log.parts["search among free motions"], options.epochs);
  EXPECT_GE(log.parts["descent of free motions"], 1);
  EXPECT_LT(TrackError(whole, recording), 0.05 * MotionlessError(recording));
  int stops = 0;
  ExpectSameTwin(RunStopped(fit, 2, &stops), whole);
  EXPECT_GT(stops, 10);
}

TEST(FitDense, GivesTheSameBitsForAnyNumberOfThreads) {
  const FitData data = Swung(2);
  TrainOptions options = Options();
  const Twin one = Fit(data, options);
  options.threads = 2;
  ExpectSameTwin(Fit(data, options), one);
}

TEST(FitDense, OptimizerIsTheOneAskedFor) {
  TrainOptions options = Options();
  const FitData data = Swung();
  for (const auto optimizer :
       {TrainOptions::Optimizer::kGaussNewton, TrainOptions::Optimizer::kAdam}) {
    options.optimizer = optimizer;
    WorkLog log;
    const Twin twin =
        RunLogged([&](const Work& work) { return FitDense(data, options, work); }, &log);
    const bool adam = optimizer == TrainOptions::Optimizer::kAdam;
    EXPECT_EQ(log.parts["single springs (Adam)"] > 0, adam);
    EXPECT_EQ(log.parts["single springs (Gauss-Newton)"] > 0, !adam);
    EXPECT_LT(TrackError(twin, data.recordings[0]), 0.1 * MotionlessError(data.recordings[0]));
  }
}

TEST(FitDense, SaysThatTooFewSubstepsWereGiven) {
  FitData data = Swung();
  data.recordings[0] = SwungRope(60, 400);
  TrainOptions options = Options();
  options.substeps = 1;
  try {
    Fit(data, options);
    ADD_FAILURE() << "one sub-step a frame went well";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "recording rope: the motion diverges with every start value tried; 1 sub-steps "
                 "a frame are too few");
  }
}

// Its hands move later than their clock says.
TEST(DenseFit, FindsTheOffsetOfTwoClocks) {
  FitData data = Swung(1, {{"control_latency", Eigen::VectorXd::Constant(1, 0.03)}});
  EXPECT_FALSE(Fit(data, Options()).clock_offset.has_value());
  data.recordings[0].two_clocks = true;
  const Twin twin = Fit(data, Options());
  ASSERT_TRUE(twin.clock_offset.has_value());
  EXPECT_NEAR(*twin.clock_offset, 0.03, 0.003);
  EXPECT_TRUE(twin.levels[0].system.effects.empty());
  const Recording by_its_clock = ByClockOf(twin, data).recordings[0];
  EXPECT_LT(TrackError(twin, by_its_clock), 0.1 * MotionlessError(by_its_clock));
}

}  // namespace
}  // namespace physpring
