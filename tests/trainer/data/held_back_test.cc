// SPDX-License-Identifier: Apache-2.0
#include "trainer/data/held_back.h"

#include <gtest/gtest.h>

#include <set>

namespace physpring {
namespace {

// One recording for each entry, of these runs; recording i has 20 + i fit frames and five more, in
// which its number can be read off the one point.
FitData OfRuns(const std::vector<int>& runs) {
  FitData data;
  data.continuous_recording = runs;
  data.recordings.resize(runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    Recording& recording = data.recordings[i];
    recording.train_frames = 20 + static_cast<int>(i);
    recording.points.assign(recording.train_frames + 5, Points::Constant(3, 1, i));
  }
  return data;
}

int RunOf(const FitData& data, const Recording& recording) {
  return data.continuous_recording[static_cast<std::size_t>(recording.points[0](0, 0))];
}

// Frames of that use.
std::set<int> Frames(const SplitRecording& split, FrameUse use) {
  std::set<int> frames;
  for (std::size_t frame = 0; frame < split.use.size(); ++frame) {
    if (split.use[frame] == use) frames.insert(static_cast<int>(frame));
  }
  return frames;
}
std::set<int> Fit(const SplitRecording& split) { return Frames(split, FrameUse::kFit); }
std::set<int> Held(const SplitRecording& split) { return Frames(split, FrameUse::kHeld); }

TEST(HoldBack, HoldsBackWholeRunsWhereThereAreFour) {
  const FitData data = OfRuns({0, 0, 1, 2, 2, 3, 4, 5, 6, 7, 7});
  const HeldBack split = HoldBack(data, 100);
  std::set<int> fit, judged;
  for (const SplitRecording& one : split.fit) {
    fit.insert(RunOf(data, *one.recording));
    EXPECT_EQ(Fit(one).size(), one.recording->train_frames - 1u);
    EXPECT_TRUE(Held(one).empty());
  }
  for (const SplitRecording& one : split.judged) {
    judged.insert(RunOf(data, *one.recording));
    EXPECT_EQ(Held(one).size(), one.recording->train_frames - 1u);
  }
  EXPECT_EQ(judged.size(), 2u);  // a quarter of 8
  EXPECT_EQ(fit.size(), 6u);
  for (int run : judged) EXPECT_FALSE(fit.contains(run)) << run;
  EXPECT_EQ(split.fit.size() + split.judged.size(), data.recordings.size());
}

TEST(HoldBack, FourRunsAreEnough) {
  const FitData data = OfRuns({3, 5, 8, 9});
  const HeldBack split = HoldBack(data, 100);
  EXPECT_EQ(split.judged.size(), 1u);
  EXPECT_EQ(split.fit.size(), 3u);
}

TEST(HoldBack, HoldsBackTwoEighthsOfFewerRuns) {
  const FitData data = OfRuns({0, 0, 1, 1, 2, 2});
  const HeldBack split = HoldBack(data, 100);
  ASSERT_EQ(split.fit.size(), data.recordings.size());
  ASSERT_EQ(split.judged.size(), data.recordings.size());
  for (std::size_t i = 0; i < split.fit.size(); ++i) {
    const std::set<int> fit = Fit(split.fit[i]), held = Held(split.judged[i]);
    const int last = data.recordings[i].train_frames - 1;
    EXPECT_EQ(split.judged[i].recording, &data.recordings[i]);
    EXPECT_EQ(fit.size() + held.size(), static_cast<std::size_t>(last));
    for (int frame : held) EXPECT_FALSE(fit.contains(frame)) << frame;
    EXPECT_NEAR(static_cast<double>(held.size()), 0.25 * last, 2);
    EXPECT_TRUE(held.contains(last));  // the end, and frames in the middle:
    EXPECT_LT(*held.begin(), 0.55 * last);
    EXPECT_GT(*fit.rbegin(), 0.8 * last);
    EXPECT_EQ(Fit(split.judged[i]), fit);     // an observer sees everything there, ...
    EXPECT_TRUE(Held(split.fit[i]).empty());  // ... and here what is fitted
  }
}

TEST(HoldBack, LeavesSomethingOnBothSidesOfShortRecordings) {
  for (int frames = 2; frames < 20; ++frames) {
    FitData data = OfRuns({0});
    data.recordings[0].train_frames = frames;
    const HeldBack split = HoldBack(data, 100);
    EXPECT_FALSE(Fit(split.fit[0]).empty()) << frames;
    EXPECT_FALSE(Held(split.judged[0]).empty()) << frames;
    ASSERT_EQ(split.FitEpisodes().size(), 1u);
    EXPECT_EQ(split.FitEpisodes()[0].recording, &data.recordings[0]);
    EXPECT_EQ(split.FitEpisodes()[0].use, &split.fit[0].use);
    EXPECT_EQ(split.FitEpisodes()[0].frames, frames);
  }
}

TEST(HoldBack, TakesAtMostAsManyRecordingsAsAsked) {
  const FitData data = OfRuns({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11});
  const HeldBack split = HoldBack(data, 2);
  ASSERT_EQ(split.fit.size(), 2u);
  EXPECT_EQ(split.judged.size(), 2u);
  EXPECT_NE(RunOf(data, *split.fit[0].recording), RunOf(data, *split.fit[1].recording));
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

TEST(ShortMotions, AreTheFirstFramesOfManyParticles) {
  FitData data = OfRuns({0, 1});
  for (Recording& recording : data.recordings) {
    recording.fps = 30;
    recording.train_frames = 201;
    recording.points[0] = Points::Zero(3, 150);
  }
  EXPECT_EQ(ParticleFrames(data, 2), 2 * 200 * 150);
  EXPECT_EQ(ParticleFrames(data, 1), 200 * 150);
  const auto frames = [&](int most) {
    return ShortMotions(data, most).recordings[1].train_frames - 1;
  };
  EXPECT_EQ(frames(1), 200);  // few enough
  EXPECT_EQ(frames(2), 134);  // two thirds of them are
  for (Recording& recording : data.recordings) recording.points[0] = Points::Zero(3, 5000);
  EXPECT_EQ(frames(2), 40);
  for (Recording& recording : data.recordings) recording.fps = 60;
  EXPECT_EQ(frames(2), 80);  // 4/3 s
  for (Recording& recording : data.recordings) recording.train_frames = 31;
  EXPECT_EQ(frames(2), 30);
}

TEST(HoldBackMotion, HoldsBackTheLaterThirdOfFewRecordings) {
  const FitData data = OfRuns({0, 1});
  const HeldBackMotion split = HoldBackMotion(data, 100);
  ASSERT_EQ(split.fit.recordings.size(), 2u);
  ASSERT_EQ(split.judged.size(), 2u);
  const std::vector<Episode> judged = split.JudgedEpisodes();
  for (std::size_t i = 0; i < 2; ++i) {
    const int last = data.recordings[i].train_frames - 1;
    const int earlier = split.fit.recordings[i].train_frames;
    EXPECT_NEAR(earlier, 2. / 3 * last + 1, 1);
    EXPECT_EQ(*Held(split.judged[i]).begin(), earlier);
    EXPECT_EQ(*Held(split.judged[i]).rbegin(), last);
    EXPECT_TRUE(Fit(split.judged[i]).empty());
    EXPECT_EQ(judged[i].recording, &data.recordings[i]);
    EXPECT_EQ(judged[i].frames, last + 1);
  }
}

TEST(HoldBackMotion, HoldsBackWholeRunsWhereThereAreFour) {
  const FitData data = OfRuns({0, 0, 1, 2, 2, 3});
  const HeldBackMotion split = HoldBackMotion(data, 100);
  ASSERT_EQ(split.judged.size() + split.fit.recordings.size(), data.recordings.size());
  ASSERT_FALSE(split.judged.empty());
  std::set<int> fit(split.fit.continuous_recording.begin(), split.fit.continuous_recording.end());
  for (const SplitRecording& one : split.judged) {
    EXPECT_FALSE(fit.contains(RunOf(data, *one.recording)));
    EXPECT_EQ(Held(one).size(), one.recording->train_frames - 1u);
  }
  EXPECT_EQ(HoldBackMotion(data, 1).judged.size(), 1u);
}

TEST(HoldBackMotion, LeavesOneFrameOnEachSide) {
  FitData data = OfRuns({0});
  data.recordings[0].train_frames = 3;
  const HeldBackMotion split = HoldBackMotion(data, 1);
  EXPECT_EQ(split.fit.recordings[0].train_frames, 2);
  EXPECT_EQ(Held(split.judged[0]), std::set<int>{2});
}

}  // namespace
}  // namespace physpring
