// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/smooth_choice.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/interrupted_work.h"
#include "tests/support/swung_rope.h"
#include "trainer/bodies/candidates.h"
#include "trainer/bodies/start_system.h"
#include "trainer/data/held_back.h"

namespace physpring {
namespace {

// A rope that lies on the ground and is dragged askew, its springs of one axial stiffness and one
// loss time, measured with noise.
FitData DraggedRope(FrictionCone cone) {
  constexpr int kParticles = 8, kFrames = 30;
  constexpr double kLossTime = 2e-3;
  Recording recording = SwungRope(kParticles, kFrames);
  recording.ground = Eigen::Vector4d(0, 0, 1, 0);
  for (auto point : recording.start.colwise()) {
    point = Eigen::Vector3d(point[2], point[0], 0.003 + point[1]);
  }
  recording.rest = recording.start;
  for (int t = 0; t < kFrames; ++t) {
    recording.points[t] = recording.start.leftCols(kParticles);
    recording.controllers[t] = recording.start.rightCols(1);
    recording.controllers[t](0, 0) += 0.004 * t;
    recording.controllers[t](1, 0) += 0.03 * std::sin(0.3 * t);
  }
  SpringMassSystem truth =
      MakeStartSystem(recording, {.max_neighbours = 6, .controller_max_neighbours = 6});
  ScaleToSubsteps(1 / recording.fps, 12, 0.7, &truth);
  truth.dashpot = kLossTime * truth.stiffness;
  truth.contact.surface.friction = 0.6;
  truth.contact.surface.cone = cone;
  MoveAs(truth, true, &recording);
  AddNoise(&recording, 5);
  FitData data;
  data.recordings.push_back(std::move(recording));
  data.continuous_recording.push_back(0);
  return data;
}

TEST(SmoothChoice, FindsTheConeOfFrictionThatTheChoiceMissed) {
  constexpr FrictionCone kElliptic = FrictionCone::kElliptic, kPyramidal = FrictionCone::kPyramidal;
  for (const auto& [cone, chosen] : {std::pair{kElliptic, kPyramidal}, {kPyramidal, kElliptic}}) {
    const FitData data = DraggedRope(cone);
    TrainOptions options;
    options.neighbours = {6};
    options.controller_velocity = true;
    ChosenBody model{CandidateBodies(data.recordings[0], options)[0], 8, {}, {}};
    model.body.cone = chosen;
    model.factors = Eigen::VectorXd::Zero(model.ParametersOf(data.recordings[0]).size());
    const std::vector<Episode> episodes = FitEpisodes(data, 1);
    const FrictionCone found = RunToTheEnd([&](const Work& work) {
      return ChooseSmoothBody(model, episodes, options, /*few=*/true, work).model.body.cone;
    });
    EXPECT_EQ(found, cone);
  }
}

}  // namespace
}  // namespace physpring
