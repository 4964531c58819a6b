// SPDX-License-Identifier: Apache-2.0
#include "tracker/side_by_side.h"

#include <gtest/gtest.h>

#include "tests/support/swung_rope.h"
#include "trainer/bodies/start_system.h"
#include "twin/recorded_input.h"

namespace physpring {
namespace {

TEST(SideBySide, MovesEachStateAsItWouldMoveAlone) {
  constexpr int kParticles = 20, kFrames = 10, kStates = 4;
  const Recording rope = SwungRope(kParticles, kFrames);
  const SpringMassSystem system = MakeStartSystem(rope, {});
  const Environment environment{rope.gravity, rope.ground};
  const SimulationOptions options{1 / rope.fps, 300, true};
  SideBySide together(system, environment, options, kStates);
  const Simulator<double> alone(system, environment, options);
  Simulator<double>::Workspace workspace(alone);
  std::vector<NodeStates<double>> a, b;
  for (int i = 0; i < kStates; ++i) {
    const Points velocity = Points::Constant(3, kParticles, 0.3 * i);
    a.push_back(together.simulator().MakeState(rope.points[0], velocity));
    b.push_back(alone.MakeState(rope.points[0], velocity));
  }
  for (int t = 1; t < kFrames; ++t) {
    const FrameInput input = RecordedInput(rope, t, 0);
    together.AdvanceFrame(input, {&a[0], &a[1], &a[2], &a[3]});
    for (int i = 0; i < kStates; ++i) {
      alone.AdvanceFrame(input, &b[i], &workspace);
      ASSERT_EQ(alone.Positions(a[i]), alone.Positions(b[i])) << t << " " << i;
      ASSERT_EQ(alone.Velocities(a[i]), alone.Velocities(b[i])) << t << " " << i;
    }
  }
  EXPECT_NE(alone.Positions(a[0]), alone.Positions(a[1]));
}

}  // namespace
}  // namespace physpring
