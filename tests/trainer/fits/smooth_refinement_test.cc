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

// The motion of the truth, measured with noise.
FitData Measured(double jitter) {
  Recording recording = Jittered(SwungSheet(40), jitter);
  MoveAs(Truth(recording), true, &recording);
  AddNoise(&recording, 3);
  FitData data;
  data.recordings.push_back(std::move(recording));
  data.continuous_recording.push_back(0);
  return data;
}

// How far the springs' stiffnesses are from those of the truth, in logarithms.
double Strayed(const SpringMassSystem& system, const SpringMassSystem& truth) {
  return (system.stiffness.array() / truth.stiffness.array()).log().abs().mean();
}

class SmoothRefinement : public testing::Test {
 protected:
  explicit SmoothRefinement(double jitter = 0) : data_(Measured(jitter)) {
    options_.neighbours = {kNeighbours};
    options_.controller_velocity = true;
    model_.factors = Eigen::VectorXd::Zero(model_.ParametersOf(recording_).size());
  }

  SmoothlyChosen Chosen(const Work& work) const {
    return ChooseSmoothBody(model_, episodes_, options_, /*few=*/true, work);
  }
  SmoothlyChosen Refined(const SmoothlyChosen& chosen, const Work& work) const {
    return Refine(chosen, episodes_, options_, work);
  }

  const FitData data_;
  const Recording& recording_ = data_.recordings[0];
  const std::vector<Episode> episodes_ = FitEpisodes(data_, 1);
  const SpringMassSystem truth_ = Truth(recording_);
  TrainOptions options_;
  ChosenBody model_{CandidateBodies(recording_, options_)[0], 8, {}, {}};
};

// The net ends with the springs of the truth, fits as well, and is held near a uniform one.
TEST_F(SmoothRefinement, LeavesOutWhatTheObjectHasNot) {
  const auto [before, after] = RunToTheEnd([&](const Work& work) {
    const SmoothlyChosen chosen = Chosen(work.Part("choice", 0, 0.5));
    return std::pair{chosen, Refined(chosen, work.Part("refined", 0.5, 1))};
  });
  const SpringMassSystem dense = before.fit.System(), sparse = after.fit.System();
  ASSERT_GT(dense.spring_count(), 1.2 * truth_.spring_count());
  ASSERT_EQ(sparse.springs, truth_.springs);
  const auto error = [&](const SpringMassSystem& system) {
    const RolloutOptions free = FollowOptions(recording_, model_.body, options_).rollout;
    return GeometricTrackError(system, episodes_, FrameUse::kFit, free);
  };
  EXPECT_LE(error(sparse), 1.02 * error(dense));
  EXPECT_LT(Strayed(sparse, truth_), 0.02);
  const SmoothBody::Widths settled = after.fit.body.options().widths, wide;
  EXPECT_LT(settled.field, wide.field);
  EXPECT_LT(settled.classes, wide.classes);
  EXPECT_LT(settled.hands, wide.hands);
}

// The shortest springs hardly stretch: a fit that has made them much stiffer does not find all the
// way back alone.
TEST_F(SmoothRefinement, BringsBackAClassThatIsLost) {
  options_.substeps = 100;
  const SmoothBody body(truth_, recording_, *model_.body.kind, {.most_rate = 5000});
  Eigen::VectorXd x = Eigen::VectorXd::Zero(body.size());
  x[body.factors().first_class()] = 2;
  const SmoothlyChosen lost{{body, x}, model_, 0, options_.substeps};
  const auto [alone, refined] = RunToTheEnd([&](const Work& work) {
    return std::pair{FitToTheEnd(lost.fit, model_, episodes_, options_, work.Part("alone", 0, 0.5)),
                     Refined(lost, work.Part("refined", 0.5, 1))};
  });
  EXPECT_LT(Strayed(refined.fit.System(), truth_), 0.5 * Strayed(alone.System(), truth_));
}

class IrregularRefinement : public SmoothRefinement {
 protected:
  IrregularRefinement() : SmoothRefinement(0.3) {}
};

// Its lengths fall into no classes, and the truth ends within one that holds other springs, too.
TEST_F(IrregularRefinement, EndsWhereTheObjectEnds) {
  const SmoothlyChosen after = RunToTheEnd([&](const Work& work) {
    return Refined(Chosen(work.Part("choice", 0, 0.5)), work.Part("refined", 0.5, 1));
  });
  ASSERT_TRUE(after.fit.body.factors().classes().irregular);
  EXPECT_EQ(after.fit.System().springs, truth_.springs);
  EXPECT_LT(Strayed(after.fit.System(), truth_), 0.03);
}

}  // namespace
}  // namespace physpring
