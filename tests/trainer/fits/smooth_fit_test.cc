// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/smooth_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "tests/support/interrupted_work.h"
#include "tests/support/swung_sheet.h"
#include "trainer/bodies/candidates.h"
#include "trainer/bodies/start_system.h"
#include "trainer/data/held_back.h"

namespace physpring {
namespace {

// How much lower the objective |r|^2 / variance + prior would be where the gradient vanishes, if
// the residuals were linear.
double LeftToGain(const SmoothlyFitted& fit, const LinearisedFit& linearised) {
  const auto& [residuals, slope] = linearised;
  const double variance = residuals.squaredNorm() / static_cast<double>(residuals.size());
  const Eigen::MatrixXd precision = fit.body.Precision(fit.x);
  const Eigen::VectorXd gradient = slope.transpose() * residuals / variance + precision * fit.x;
  const Eigen::MatrixXd normal = slope.transpose() * slope / variance + precision;
  return gradient.dot(normal.ldlt().solve(gradient));
}

// Less than one variance of the noise is left to gain, with options of floats and of doubles.
TEST(FitToTheEnd, EndsAtTheBottom) {
  Recording recording = SwungSheet(60);
  SpringMassSystem truth =
      MakeStartSystem(recording, {.max_neighbours = 8, .controller_max_neighbours = 8});
  ScaleToSubsteps(1 / recording.fps, 40, 0.7, &truth);
  truth.dashpot = 2e-3 * truth.stiffness;
  MoveAs(truth, true, &recording);
  AddNoise(&recording, 3);
  FitData data;
  data.recordings.push_back(std::move(recording));
  data.continuous_recording.push_back(0);
  const Recording& measured = data.recordings[0];
  const std::vector<Episode> episodes = FitEpisodes(data, 1);
  for (bool single_precision : {true, false}) {
    TrainOptions options;
    options.neighbours = {8};
    options.controller_velocity = true;
    options.single_precision = single_precision;
    const ChosenBody model{CandidateBodies(measured, options)[0], 8, {}, {}};
    const SmoothBody body(truth, measured, *model.body.kind, {.most_rate = 1e5});
    Eigen::VectorXd x(body.size());
    for (int i = 0; i < body.size(); ++i) x[i] = 0.1 * std::sin(3 * i);
    const SmoothlyFitted fit = RunToTheEnd([&](const Work& work) {
      return FitToTheEnd({body, x}, model, episodes, options, work);
    });
    const auto linearised = LineariseFit(fit, model, episodes, options);
    ASSERT_TRUE(linearised);
    EXPECT_LT(LeftToGain(fit, *linearised), 1) << single_precision;
  }
}

// A net in an irregular mesh gets springs beyond its radius, and they alone begin soft (by whole
// classes of length: a few shorter ones may, too).
TEST(SoftSmoothBody, SpringsBeyondTheChosenRadiusBeginSoft) {
  FitData data;
  data.recordings.push_back(Jittered(SwungSheet(10), 0.3));
  data.continuous_recording.push_back(0);
  const Recording& measured = data.recordings[0];
  TrainOptions options;
  options.neighbours = {12};
  const Body chosen = CandidateBodies(measured, options)[0];
  ChosenBody model{WithSoftSprings(chosen, measured), 8, {}, {}};
  ASSERT_GT(model.body.radius, 1.05 * chosen.radius);
  model.factors = Eigen::VectorXd::Zero(model.ParametersOf(measured).size());
  const SpringMassSystem system =
      SoftSmoothBody(model, FitEpisodes(data, 1), {.most_rate = 1e5}).System();
  const Eigen::VectorXd axial = system.stiffness.cwiseProduct(system.rest_length);
  int beyond = 0, within = 0, soft_within = 0;
  for (int e = 0; e < system.spring_count(); ++e) {
    const bool soft = axial[e] < 0.02 * axial.maxCoeff();
    if (system.rest_length[e] > chosen.radius) {
      EXPECT_TRUE(soft);
      ++beyond;
    } else {
      ++within;
      if (soft) ++soft_within;
    }
  }
  EXPECT_GT(beyond, 20);
  EXPECT_LT(soft_within, 0.1 * within);
}

TEST(WithSoftSprings, ChangesNoRodAndNoBodyOfFewParticles) {
  const Recording recording = SwungSheet(2);
  const Body rod{.kind = nullptr, .neighbours = 8};
  EXPECT_EQ(WithSoftSprings(rod, recording).soft_beyond, Body::kNowhere);
  const Body whole{.kind = nullptr, .neighbours = recording.particle_count() - 1, .radius = 1};
  EXPECT_EQ(WithSoftSprings(whole, recording).radius, 1);
}

}  // namespace
}  // namespace physpring
