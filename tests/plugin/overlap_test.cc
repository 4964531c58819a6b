// SPDX-License-Identifier: Apache-2.0
// Nodes that start inside a fixed surface: overlap of 1 mm is let be, a fifth of what exceeds it is
// undone in a step, at 0.2 m/s at most.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/level_scene.h"
#include "tests/support/simulation.h"

namespace physpring {
namespace {

constexpr double kRadius = 0.01, kAllowed = 1e-3, kFastest = 0.2;  // m, m, m/s
const char* const kPlane = R"(<geom type="plane" size="0 0 1"/>)";
const char* const kBox = R"(<geom type="box" size="1 1 0.1" pos="0 0 -0.1"/>)";

// Two balls, joined by a spring of their distance, that overlap the ground.
struct Sunk {
  LevelScene scene;

  Sunk(double overlap, double timestep, const LevelSceneOptions& more)
      : scene(Balls(overlap), With(timestep, more)) {}

  double gap() const { return scene.Positions().row(2).minCoeff() - kRadius; }
  double speed() const { return scene.Velocities().cwiseAbs().maxCoeff(); }

 private:
  static SpringMassSystem Balls(double overlap) {
    const double height = kRadius - overlap;
    SpringMassSystem balls =
        Particles((Points(3, 2) << 0, 0.1, 0, 0, height, height).finished(), 0.1);
    AddSpring(0, 1, 100, 0.1, 0, &balls);
    balls.contact = {{0.5, 0.3}, {0, 0}, 0};
    balls.contact_radius.setConstant(kRadius);
    return balls;
  }
  static LevelSceneOptions With(double timestep, LevelSceneOptions more) {
    more.contact = true;
    more.timestep = timestep;
    more.substep = timestep / 4;
    return more;
  }
};

TEST(Overlap, UpToAMillimetreIsLetBe) {
  for (bool plugin_springs : {false, true}) {
    Sunk sunk(0.999 * kAllowed, 2e-3,
              {.plugin_springs = plugin_springs, .gravity = {0, 0, 0}, .world = kPlane});
    sunk.scene.Step(100);
    EXPECT_EQ(sunk.speed(), 0);
  }
}

TEST(Overlap, AFifthOfWhatExceedsItIsUndoneInAStep) {
  for (const char* world : {kPlane, kBox}) {
    for (double overlap : {1.5e-3, 5e-3}) {
      const double h = 2e-3;
      Sunk sunk(overlap, h, {.plugin_springs = false, .gravity = {0, 0, 0}, .world = world});
      sunk.scene.Step(1);
      const double rate = std::min(0.2 * (overlap - kAllowed) / h, kFastest);
      EXPECT_NEAR(sunk.gap(), -overlap + h * rate, 1e-12);
    }
  }
}

TEST(Overlap, NodesComeOutWithoutBeingThrown) {
  for (bool plugin_springs : {false, true}) {
    for (double timestep : {2e-3, 0.2e-3}) {
      for (const char* world : {kPlane, kBox}) {
        Sunk sunk(5e-3, timestep, {.plugin_springs = plugin_springs, .world = world});
        double fastest = 0;
        for (int i = 0; i < std::lround(1 / timestep); ++i) {
          sunk.scene.Step();
          fastest = std::max(fastest, sunk.speed());
        }
        EXPECT_GT(sunk.gap(), -kAllowed);
        EXPECT_LT(sunk.gap(), 1e-4);
        // what falls back is as fast, but for a step
        EXPECT_LT(fastest, kFastest + 9.81 * timestep);
      }
    }
  }
}

}  // namespace
}  // namespace physpring
