// SPDX-License-Identifier: Apache-2.0
#include "trainer/hierarchy_fit.h"

#include <gtest/gtest.h>

#include <memory>

#include "tests/support/small_twin.h"
#include "trainer/finished_fit.h"
#include "twin/error.h"
#include "twin/evaluate.h"

namespace physpring {
namespace {

using Reduction = TrainOptions::Reduction;

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
  HierarchyFit Fit() const {
    return HierarchyFit(data, options, std::make_unique<FinishedFit>(dense));
  }
};

Twin RunToTheEnd(HierarchyFit* fit) {
  while (fit->Step()) {
  }
  return fit->Result();
}

void ExpectSameSystem(const SpringMassSystem& a, const SpringMassSystem& b) {
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.springs, b.springs);
  EXPECT_EQ(a.stiffness, b.stiffness);
  EXPECT_EQ(a.rest_length, b.rest_length);
  EXPECT_EQ(a.dashpot, b.dashpot);
  EXPECT_EQ(a.drag, b.drag);
  EXPECT_EQ(a.contact.restitution, b.contact.restitution);
  EXPECT_EQ(a.contact.friction, b.contact.friction);
}

void ExpectSameTwin(const Twin& a, const Twin& b) {
  ASSERT_EQ(a.levels.size(), b.levels.size());
  for (std::size_t l = 0; l < a.levels.size(); ++l) {
    SCOPED_TRACE(l);
    EXPECT_EQ(a.levels[l].assignment, b.levels[l].assignment);
    EXPECT_EQ(a.levels[l].substeps_per_second, b.levels[l].substeps_per_second);
    ExpectSameSystem(a.levels[l].system, b.levels[l].system);
  }
}

TEST(HierarchyFit, MakesLevelsOfTheRatiosWithTheSameMass) {
  for (Reduction reduction :
       {Reduction::kLearned, Reduction::kRandom, Reduction::kGramian, Reduction::kKMeans}) {
    Case c;
    c.options.reduction = reduction;
    HierarchyFit fit = c.Fit();
    const Twin twin = RunToTheEnd(&fit);
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
    EXPECT_EQ(fit.Progress(), 1);
  }
}

// The fit of a level lowers its error below that of the projection alone.
TEST(HierarchyFit, FitsTheParametersOfALevel) {
  Case c;
  c.options.levels = 2;
  c.options.reduction = Reduction::kKMeans;
  HierarchyFit fit = c.Fit();
  fit.Step();  // level 0
  fit.Step();  // the projection
  const auto error = [&](const Twin& twin) {
    const RecordingResult result = Evaluate(twin, c.data.recordings[0], {});
    return *MeansOverFrames(result.levels[1].lifted, 1, 8).track.value;
  };
  const double projected = error(fit.Result());
  EXPECT_LT(error(RunToTheEnd(&fit)), 0.7 * projected);
}

TEST(HierarchyFit, ResumedAnywhereGivesTheSameBits) {
  const Case c;
  HierarchyFit whole = c.Fit();
  const Twin expected = RunToTheEnd(&whole);
  HierarchyFit first = c.Fit();
  bool more = true;
  for (int steps = 0; more; ++steps) {
    more = first.Step();
    if (steps % 31 != 3) continue;  // topology, trials, network, springs of both levels
    HierarchyFit second = c.Fit();
    second.Load(first.Save());
    SCOPED_TRACE(first.Status());
    EXPECT_EQ(second.Progress(), first.Progress());
    ExpectSameTwin(RunToTheEnd(&second), expected);
  }
}

// On a ground, where restitution and friction are updated, too.
TEST(HierarchyFit, UpdatesContactAndResumesThere) {
  Case c;
  Recording& recording = c.data.recordings[0];
  recording.ground = Eigen::Vector4d(0, 0, 1, recording.start.row(2).minCoeff());
  c.options.levels = 2;
  c.options.reduction = Reduction::kKMeans;
  c.options.network.contact_updates = 3;
  c.options.network.epochs = 4;
  HierarchyFit fit = c.Fit();
  bool more = true, moved = false;
  for (int steps = 0; more; ++steps) {
    more = fit.Step();
    if (fit.Part() != "network") continue;
    const StateArrays saved = fit.Save();
    moved = moved || !LoadVector(saved, "trial0/contact", 2).isZero(0);
    HierarchyFit second = c.Fit();
    second.Load(saved);
    EXPECT_EQ(LoadVector(second.Save(), "trial0/contact", 2),
              LoadVector(saved, "trial0/contact", 2));
  }
  EXPECT_TRUE(moved);
}

TEST(HierarchyFit, DoesNotDependOnTheNumberOfThreads) {
  Case one, three;
  one.options.levels = three.options.levels = 2;
  three.options.threads = 3;
  HierarchyFit a = one.Fit(), b = three.Fit();
  ExpectSameTwin(RunToTheEnd(&a), RunToTheEnd(&b));
}

TEST(HierarchyFit, RefusesLevelsThatAreNoCoarser) {
  Case c;
  c.options.ratios = {0.5, 0.5};
  try {
    c.Fit();
    FAIL() << "was not refused";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "--ratios 0.5: level 2 of 40 particles would have 20 nodes, expected 2 to 19");
  }
}

}  // namespace
}  // namespace physpring
