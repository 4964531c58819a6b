// SPDX-License-Identifier: Apache-2.0
#include "trainer/held_back.h"

#include <gtest/gtest.h>

#include <set>

namespace physpring {
namespace {

// One recording for each entry, of these runs; recording i has 20 + i fit frames.
FitData OfRuns(const std::vector<int>& runs) {
  FitData data;
  data.continuous_recording = runs;
  data.recordings.resize(runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    data.recordings[i].train_frames = 20 + static_cast<int>(i);
  }
  return data;
}

int RunOf(const FitData& data, const Recording* recording) {
  return data.continuous_recording[recording - data.recordings.data()];
}

void ExpectWithinFitFrames(const HeldBack& split) {
  for (const Episode& episode : split.fit) {
    EXPECT_GE(episode.frames, 2);
    EXPECT_LE(episode.frames, episode.recording->train_frames);
  }
  for (const ScoredFrames& scored : split.scored) {
    EXPECT_GE(scored.first, 1);
    EXPECT_LT(scored.first, scored.last);
    EXPECT_LE(scored.last, scored.recording->train_frames);
  }
}

TEST(HoldBack, HoldsBackWholeRunsWhereThereAreFour) {
  const FitData data = OfRuns({0, 0, 1, 2, 2, 3, 4, 5, 6, 7, 7});
  const HeldBack split = HoldBack(data, 100);
  std::set<int> fit, scored;
  for (const Episode& episode : split.fit) {
    fit.insert(RunOf(data, episode.recording));
    EXPECT_EQ(episode.frames, episode.recording->train_frames);
  }
  for (const ScoredFrames& frames : split.scored) {
    scored.insert(RunOf(data, frames.recording));
    EXPECT_EQ(frames.first, 1);
    EXPECT_EQ(frames.last, frames.recording->train_frames);
  }
  EXPECT_EQ(scored.size(), 2u);  // a quarter of 8
  EXPECT_EQ(fit.size(), 6u);
  for (int run : scored) EXPECT_FALSE(fit.contains(run)) << run;
  EXPECT_EQ(split.fit.size() + split.scored.size(), data.recordings.size());
  ExpectWithinFitFrames(split);
}

TEST(HoldBack, FourRunsAreEnough) {
  const HeldBack split = HoldBack(OfRuns({3, 5, 8, 9}), 100);
  EXPECT_EQ(split.scored.size(), 1u);
  EXPECT_EQ(split.fit.size(), 3u);
}

TEST(HoldBack, HoldsBackTheLastQuarterOfFewerRuns) {
  const FitData data = OfRuns({0, 0, 1, 1, 2, 2});
  const HeldBack split = HoldBack(data, 100);
  ASSERT_EQ(split.fit.size(), data.recordings.size());
  ASSERT_EQ(split.scored.size(), data.recordings.size());
  for (std::size_t i = 0; i < split.fit.size(); ++i) {
    EXPECT_EQ(split.fit[i].recording, split.scored[i].recording);
    EXPECT_EQ(split.scored[i].first, split.fit[i].frames);
    EXPECT_EQ(split.scored[i].last, data.recordings[i].train_frames);
    EXPECT_NEAR(split.fit[i].frames, 0.75 * data.recordings[i].train_frames, 1);
  }
}

TEST(HoldBack, NeverPassesTheFitFramesOfShortRecordings) {
  for (int frames = 2; frames < 10; ++frames) {
    FitData data = OfRuns({0});
    data.recordings[0].train_frames = frames;
    ExpectWithinFitFrames(HoldBack(data, 100));
  }
}

TEST(HoldBack, TakesAtMostAsManyRecordingsAsAsked) {
  const FitData data = OfRuns({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11});
  const HeldBack split = HoldBack(data, 2);
  EXPECT_EQ(split.fit.size(), 2u);
  EXPECT_EQ(split.scored.size(), 2u);
  EXPECT_NE(split.fit[0].recording, split.fit[1].recording);
  ExpectWithinFitFrames(split);
}

TEST(FitEpisodes, AreAllFitFramesOfRecordingsSpreadEvenly) {
  const FitData data = OfRuns({0, 0, 0, 0, 0, 0});
  EXPECT_EQ(FitEpisodes(data, 6).size(), 6u);
  const std::vector<Episode> some = FitEpisodes(data, 3);
  ASSERT_EQ(some.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(some[i].recording, &data.recordings[2 * i + 1]);
    EXPECT_EQ(some[i].frames, 20 + 2 * i + 1);
  }
}

}  // namespace
}  // namespace physpring
