// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/split_recording.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace physpring {
namespace {

using Use = SplitRecording::Use;

Recording Frames(int frames, int train_frames) {
  Recording recording;
  recording.fps = 10;
  recording.train_frames = train_frames;
  recording.points.assign(static_cast<std::size_t>(frames), Points::Zero(3, 1));
  return recording;
}

long Count(const SplitRecording& split, Use use) {
  return std::count(split.use.begin(), split.use.end(), use);
}

TEST(SplitRecording, HoldsOutTheFuture) {
  const Recording recording = Frames(20, 14);
  const SplitRecording split = HoldOutFrames(recording);
  EXPECT_EQ(split.last(Use::kFit), 14);
  EXPECT_EQ(Count(split, Use::kHeld), 6);
  EXPECT_EQ(split.use[0], Use::kNone);
}

TEST(SplitRecording, FitsWhatWasHeldOut) {
  const Recording recording = Frames(20, 14);
  const SplitRecording split = FitHeldOut(HoldOutFrames(recording));
  EXPECT_EQ(Count(split, Use::kFit), 19);
  EXPECT_EQ(split.use[0], Use::kNone);
}

TEST(SplitRecording, HoldsOutEveryFourthBlockWhereThereIsNoFuture) {
  const Recording recording = Frames(25, 25);  // blocks of three frames
  const SplitRecording split = HoldOutFrames(recording);
  EXPECT_EQ(split.use[8], Use::kFit);
  for (std::size_t frame = 9; frame < 12; ++frame) EXPECT_EQ(split.use[frame], Use::kHeld);
  EXPECT_EQ(split.use[12], Use::kFit);
  EXPECT_EQ(Count(split, Use::kHeld), 6);
}

TEST(SplitRecording, ShorterBlocksForAShortRecording) {
  const Recording recording = Frames(10, 10);  // blocks of two frames, not of three
  const SplitRecording split = HoldOutFrames(recording);
  EXPECT_EQ(split.use[5], Use::kFit);
  EXPECT_EQ(split.use[6], Use::kHeld);
  EXPECT_EQ(split.use[7], Use::kHeld);
  EXPECT_EQ(Count(split, Use::kHeld), 2);
}

// Swings until frame `last`, then rests.
Recording ComesToRest(int frames, int train_frames, int last, double noise) {
  Recording recording = Frames(frames, train_frames);
  for (std::size_t frame = 0; frame < recording.points.size(); ++frame) {
    const double sign = frame % 2 == 0 ? 1 : -1;
    const bool moves = static_cast<int>(frame) <= last;
    recording.points[frame](0, 0) = moves ? 0.1 * sign : noise * sign;
    recording.controllers.emplace_back(Points::Zero(3, 1));
  }
  return recording;
}

TEST(SplitRecording, LeavesOutRest) {
  const Recording recording = ComesToRest(40, 40, 20, 1e-4);
  SplitRecording split = UseAll(recording, Use::kFit);
  EXPECT_EQ(LeaveOutRest(0, &split), 40 - 21 - 5);
  EXPECT_EQ(split.last(Use::kFit), 21 + 5);
}

TEST(SplitRecording, WhatStaysWithinTheNoiseRests) {
  const Recording recording = ComesToRest(40, 40, 20, 3e-3);
  SplitRecording split = UseAll(recording, Use::kFit);
  EXPECT_EQ(LeaveOutRest(1e-4, &split), 0);
  EXPECT_EQ(LeaveOutRest(3e-3, &split), 40 - 21 - 5);
}

TEST(SplitRecording, NothingRestsWhileAHandMoves) {
  Recording recording = ComesToRest(40, 40, 20, 0);
  for (std::size_t frame = 0; frame < 30; ++frame) recording.controllers[frame](1, 0) = 0.2;
  SplitRecording split = UseAll(recording, Use::kFit);
  EXPECT_EQ(LeaveOutRest(0, &split), 40 - 30 - 5);
}

TEST(SplitRecording, HalfOfWhatIsHeldOutStays) {
  const Recording recording = ComesToRest(40, 20, 10, 0);
  SplitRecording split = HoldOutFrames(recording);
  EXPECT_EQ(LeaveOutRest(0, &split), 10);
  EXPECT_EQ(Count(split, Use::kHeld), 10);
}

TEST(SplitRecording, OnlyFitFramesAreSeenInACopy) {
  const Recording recording = Frames(25, 25);
  const SplitRecording split = HoldOutFrames(recording);
  const Recording copy = OnlyFitFrames(split.All());
  EXPECT_EQ(copy.points[0], recording.points[0]);
  for (std::size_t frame = 1; frame < 25; ++frame) {
    EXPECT_EQ(copy.points[frame].hasNaN(), split.use[frame] != Use::kFit) << frame;
  }
}

}  // namespace
}  // namespace physpring
