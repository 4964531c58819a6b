// SPDX-License-Identifier: Apache-2.0
#include "trainer/motion/frame_walk.h"

#include <gtest/gtest.h>

#include "tests/support/gradient_check.h"
#include "tests/support/small_twin.h"

namespace physpring {
namespace {

constexpr RolloutOptions kOptions{.substeps = 40};

// The block's motion, measured with an offset, so that there is a loss.
Recording MeasuredMotion(const Twin& twin) {
  Recording recording = RecordingOfMotion(twin, 4);
  for (Points& frame : recording.points) frame.array() += 0.001;
  recording.points[2].col(3).setConstant(std::numeric_limits<double>::quiet_NaN());
  return recording;
}

TEST(FrameWalk, HasTheLossOfTheRollout) {
  const Twin twin = SmallTwin(1);
  const SpringMassSystem& system = twin.levels[0].system;
  const Recording recording = MeasuredMotion(twin);
  const auto rollout = RollOut(system, {&recording, 4}, kOptions);
  const auto walk = StartWalk(system, recording, kOptions, LossOptions());
  SystemGradient gradient(system);
  for (int frame = 1; frame < 4; ++frame) {
    Points unused = Points::Zero(3, system.node_count());
    EXPECT_EQ(*walk->Step(system, &gradient),
              AddFrameLoss(rollout->positions()[frame], recording, frame, LossOptions(), &unused));
  }
}

// The loss of frame 2 as a function of the parameters during frame 2 only.
TEST(FrameWalk, DerivesTheLossOfOneFrame) {
  const Twin twin = SmallTwin(1);
  const SpringMassSystem& system = twin.levels[0].system;
  const Recording recording = MeasuredMotion(twin);
  SpringMassSystem moved = system;
  const auto loss_and_gradient = [&](SystemGradient* gradient) {
    const auto walk = StartWalk(system, recording, kOptions, LossOptions());
    SystemGradient before(system);
    walk->Step(system, &before);
    return *walk->Step(moved, gradient);
  };
  SystemGradient gradient(system), unused(system);
  loss_and_gradient(&gradient);

  std::vector<CheckedVariable> variables;
  for (int e : {0, 17, system.spring_count() - 1}) {
    variables.push_back({"stiffness", &moved.stiffness[e], 1.0, gradient.stiffness[e]});
    variables.push_back({"dashpot", &moved.dashpot[e], 1e-3, gradient.dashpot[e]});
  }
  variables.push_back({"drag", &moved.drag, 1e-2, gradient.drag});
  // a loss in double has 1e-16 / 1e-7 of noise on a difference, relative to these derivatives
  const GradientReport report =
      CheckGradient([&] { return loss_and_gradient(&unused); }, variables, 1e-5);
  EXPECT_TRUE(report.passed) << report.log;
}

TEST(FrameWalk, TakesTheParametersOfEachFrame) {
  const Twin twin = SmallTwin(1);
  const SpringMassSystem& system = twin.levels[0].system;
  SpringMassSystem stiffer = system;
  stiffer.stiffness *= 2;
  const Recording recording = MeasuredMotion(twin);
  SystemGradient gradient(system);
  const auto same = StartWalk(system, recording, kOptions, LossOptions());
  const auto changed = StartWalk(system, recording, kOptions, LossOptions());
  EXPECT_EQ(*same->Step(system, &gradient), *changed->Step(system, &gradient));
  EXPECT_NE(*same->Step(system, &gradient), *changed->Step(stiffer, &gradient));
}

TEST(FrameWalk, SaysWhenTheMotionDiverges) {
  const Twin twin = SmallTwin(1);
  SpringMassSystem system = twin.levels[0].system;
  system.stiffness *= 1e6;
  const Recording recording = MeasuredMotion(twin);
  for (bool single_precision : {false, true}) {
    const auto walk = StartWalk(
        system, recording, {.single_precision = single_precision, .substeps = 40}, LossOptions());
    SystemGradient gradient(system);
    bool diverged = false;
    for (int frame = 1; frame < 4; ++frame) diverged |= !walk->Step(system, &gradient);
    EXPECT_TRUE(diverged);
  }
}

}  // namespace
}  // namespace physpring
