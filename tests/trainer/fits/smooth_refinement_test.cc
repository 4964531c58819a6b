// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/smooth_refinement.h"

#include <gtest/gtest.h>

#include "tests/support/interrupted_work.h"
#include "tests/support/swung_sheet.h"
#include "trainer/bodies/candidates.h"
#include "trainer/bodies/factors.h"
#include "trainer/bodies/start_system.h"
#include "trainer/data/held_back.h"
#include "trainer/motion/track_error.h"

namespace physpring {
namespace {

constexpr int kNeighbours = 20;

// A sheet of fewer springs than a net of kNeighbours.
SpringMassSystem Truth(const Recording& recording) {
  SpringMassSystem truth = OnlyShorter(
      MakeStartSystem(recording,
                      {.max_neighbours = kNeighbours, .controller_max_neighbours = kNeighbours}),
      2.1 * kSheetSpacing);
  ScaleToSubsteps(1 / recording.fps, 16, 0.7, &truth);
  truth.dashpot = 2e-3 * truth.stiffness;
  return truth;
}

// Its motion, measured with noise.
FitData Measured() {
  Recording recording = SwungSheet(40);
  MoveAs(Truth(recording), true, &recording);
  AddNoise(&recording, 3);
  FitData data;
  data.recordings.push_back(std::move(recording));
  data.continuous_recording.push_back(0);
  return data;
}

// The net ends with the springs of the truth, and fits as well.
TEST(SmoothRefinement, LeavesOutWhatTheObjectHasNot) {
  const FitData data = Measured();
  const Recording& recording = data.recordings[0];
  TrainOptions options;
  options.neighbours = {kNeighbours};
  options.controller_velocity = true;
  ChosenBody model{CandidateBodies(recording, options)[0], 8, {}, {}};
  model.factors = Eigen::VectorXd::Zero(model.ParametersOf(recording).size());
  const std::vector<Episode> episodes = FitEpisodes(data, 1);
  const auto [before, after] = RunToTheEnd([&](const Work& work) {
    const SmoothlyChosen chosen =
        ChooseSmoothBody(model, episodes, options, /*few=*/true, work.Part("choice", 0, 0.5));
    return std::pair{chosen, Refine(chosen, episodes, options, work.Part("refined", 0.5, 1))};
  });
  const SpringMassSystem truth = Truth(recording);
  const SpringMassSystem dense = before.fit.System(), sparse = after.fit.System();
  ASSERT_GT(dense.spring_count(), 1.2 * truth.spring_count());
  ASSERT_EQ(sparse.springs, truth.springs);
  const auto error = [&](const SpringMassSystem& system) {
    const RolloutOptions free = FollowOptions(recording, model.body, options).rollout;
    return GeometricTrackError(system, episodes, FrameUse::kFit, free);
  };
  EXPECT_LE(error(sparse), 1.02 * error(dense));
  const auto strayed = [&](const SpringMassSystem& system) {
    const Eigen::ArrayXd ratio = system.stiffness.array() / truth.stiffness.array();
    return ratio.log().abs().mean();
  };
  EXPECT_LT(strayed(sparse), 0.1);
}

}  // namespace
}  // namespace physpring
