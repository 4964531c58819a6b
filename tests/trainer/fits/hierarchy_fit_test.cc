// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/hierarchy_fit.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/interrupted_work.h"
#include "tests/support/same_twin.h"
#include "tests/support/small_twin.h"
#include "trainer/projection/galerkin.h"
#include "trainer/reduction/registry.h"
#include "twin/error.h"
#include "twin/evaluate.h"

namespace physpring {
namespace {

// Level 0 of a block of 40 particles, and its motion as a recording.
struct Case {
  Twin dense = SmallTwin(1);
  FitData data;
  TrainOptions options;

  Case() {
    Recording recording = RecordingOfMotion(dense, 8);
    recording.train_frames = 8;
    data.recordings.push_back(recording);
    data.continuous_recording = {0};
    dense.levels[0].substeps_per_second = 3000;
    options.levels = 3;
    options.ratios = {0.5, 0.25};
    options.network.latent = 4;
    options.network.epochs = 2;
  }
  Twin Fit(const Work& work) const { return FitHierarchy(dense, data, options, work); }
  Twin Fit() const {
    return RunToTheEnd([this](const Work& work) { return Fit(work); });
  }
};

TEST(HierarchyFit, MakesLevelsOfTheRatiosWithTheSameMass) {
  for (const auto& reduction : AllReductions()) {
    SCOPED_TRACE(reduction->name());
    Case c;
    c.options.reduction = reduction->name();
    const Twin twin = c.Fit();
    ASSERT_EQ(twin.levels.size(), 3u);
    EXPECT_EQ(twin.levels[1].system.node_count(), 20);
    EXPECT_EQ(twin.levels[2].system.node_count(), 10);
    ExpectSameSystem(twin.levels[0].system, c.dense.levels[0].system);
    for (int level = 0; level < 3; ++level) {
      const SpringMassSystem& system = twin.levels[level].system;
      system.Validate("level");
      EXPECT_NEAR(system.mass.sum(), c.dense.levels[0].system.mass.sum(), 1e-15);
      EXPECT_LE(twin.levels[level].substeps_per_second, 3000);
    }
  }
}

// The fit of a level lowers its error below that of the projection alone.
TEST(HierarchyFit, FitsTheParametersOfALevel) {
  Case c;
  c.options.levels = 2;
  c.options.reduction = "kmeans";
  const auto error = [&](const Twin& twin) {
    const RecordingResult result = Evaluate(twin, c.data.recordings[0], {});
    return *MeansOverFrames(result.levels[1].lifted, 1, 8).track.value;
  };
  const Twin fitted = c.Fit();
  Twin projected = fitted;
  projected.levels[1].system =
      Project(c.dense.levels[0].system, fitted.levels[1].assignment, Eigen::Vector3d::UnitZ())
          .system;
  EXPECT_LT(error(fitted), 0.7 * error(projected));
}

TEST(HierarchyFit, StoppedAnywhereGivesTheSameBits) {
  const Case c;
  const Twin whole = c.Fit();
  const auto fit = [&](const Work& work) { return c.Fit(work); };
  int stops = 0;
  ExpectSameTwin(RunStopped(fit, 3, &stops), whole);
  EXPECT_GT(stops, 20);
}

TEST(HierarchyFit, TellsHowFarItIs) {
  const Case c;
  WorkLog log;
  RunLogged([&](const Work& work) { return c.Fit(work); }, &log);
  EXPECT_TRUE(std::is_sorted(log.shares.begin(), log.shares.end()));
  EXPECT_LE(log.shares.back(), 1);
  for (const char* part : {"reduction", "common factors of coarse levels", "network",
                           "single springs of coarse levels"}) {
    EXPECT_GT(log.parts[part], 0) << part;
  }
  ASSERT_EQ(log.reached.size(), 2u);
  EXPECT_EQ(log.reached[0].levels.size(), 2u);
}

// On a ground, where restitution and friction are updated, too.
TEST(HierarchyFit, UpdatesContactStoppedOrNot) {
  Case c;
  Recording& recording = c.data.recordings[0];
  recording.ground = Eigen::Vector4d(0, 0, 1, recording.start.row(2).minCoeff());
  c.options.levels = 2;
  c.options.reduction = "kmeans";
  c.options.network.epochs = 4;
  const auto fit = [&](const Work& work) { return c.Fit(work); };
  c.options.network.contact_updates = 0;
  WorkLog without, with;
  RunLogged(fit, &without);
  c.options.network.contact_updates = 3;
  const Twin whole = RunLogged(fit, &with);
  EXPECT_GT(with.parts["network"], without.parts["network"]);
  int stops = 0;
  ExpectSameTwin(RunStopped(fit, 2, &stops), whole);
}

TEST(HierarchyFit, DoesNotDependOnTheNumberOfThreads) {
  Case one, three;
  one.options.levels = three.options.levels = 2;
  three.options.threads = 3;
  ExpectSameTwin(one.Fit(), three.Fit());
}

TEST(HierarchyFit, RefusesLevelsThatAreNoCoarser) {
  Case c;
  c.options.ratios = {0.5, 0.5};
  try {
    ExpectCoarserLevels(c.data, c.options);
    FAIL() << "was not refused";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "--ratios 0.5: level 2 of 40 particles would have 20 nodes, expected 2 to 19");
  }
}

}  // namespace
}  // namespace physpring
