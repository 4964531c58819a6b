// SPDX-License-Identifier: Apache-2.0
#include "trainer/data/held_back.h"

#include <algorithm>
#include <set>

namespace physpring {
namespace {

constexpr int kParts = 8;          // a recording's fit frames are cut into so many parts ...
constexpr int kOneHeldBackOf = 4;  // ... of which one in so many is held back
// The earlier frames of a motion, of which the later ones are held back, as a part of all.
constexpr double kEarlier = 2.0 / 3;

// A choice follows no more particles in frames (ParticleFrames) than this; but at least so many
// frames of a recording, and so many seconds.
constexpr double kEnoughParticleFrames = 4e4;
constexpr int kFewestFrames = 40;
constexpr double kFewestSeconds = 4.0 / 3;

// Whether frame 1 ... `last` is held back.
bool IsHeldBack(int frame, int last) {
  if (last < kParts) return frame == last;
  const int part = (frame - 1) * kParts / last;
  return part % kOneHeldBackOf == kOneHeldBackOf - 1;
}

// The uses of a recording's fit frames.
SplitRecording SplitFitFrames(const Recording& recording, FrameUse held_back, FrameUse others) {
  SplitRecording split = UseAll(recording, FrameUse::kNone);
  const int last = recording.train_frames - 1;
  for (int frame = 1; frame <= last; ++frame) {
    split.use[static_cast<std::size_t>(frame)] = IsHeldBack(frame, last) ? held_back : others;
  }
  return split;
}

// The recording with that use for all its fit frames.
SplitRecording UseFitFrames(const Recording& recording, FrameUse use) {
  return SplitFitFrames(recording, use, use);
}

std::vector<Episode> EpisodesOf(const std::vector<SplitRecording>& recordings) {
  std::vector<Episode> episodes;
  for (const SplitRecording& split : recordings) {
    episodes.push_back(split.First(split.recording->train_frames));
  }
  return episodes;
}

}  // namespace

std::vector<Episode> HeldBack::FitEpisodes() const { return EpisodesOf(fit); }

std::vector<Episode> HeldBack::JudgedEpisodes() const { return EpisodesOf(judged); }

std::vector<Episode> HeldBackMotion::JudgedEpisodes() const { return EpisodesOf(judged); }

std::vector<Episode> FitEpisodes(const FitData& data, int most) {
  std::vector<Episode> episodes;
  for (const Recording& recording : data.recordings) {
    episodes.push_back({&recording, recording.train_frames});
  }
  return SpreadEvenly(episodes, most);
}

double ParticleFrames(const FitData& data, int most) {
  double sum = 0;
  for (const Episode& episode : FitEpisodes(data, most)) {
    sum += static_cast<double>(episode.frames - 1) * episode.recording->particle_count();
  }
  return sum;
}

FitData ShortMotions(const FitData& data, int most) {
  FitData some = data;
  const double part = kEnoughParticleFrames / std::max(1.0, ParticleFrames(data, most));
  if (part >= 1) return some;
  for (Recording& recording : some.recordings) {
    const int last = recording.train_frames - 1;
    const int fewest =
        std::max(kFewestFrames, static_cast<int>(std::ceil(kFewestSeconds * recording.fps)));
    recording.train_frames =
        1 + std::min(last, std::max(fewest, static_cast<int>(std::ceil(part * last))));
  }
  return some;
}

std::vector<bool> HeldBackRuns(const FitData& data) {
  std::vector<bool> held_back(data.recordings.size(), false);
  const std::set<int> runs(data.continuous_recording.begin(), data.continuous_recording.end());
  if (runs.size() < kOneHeldBackOf) return held_back;
  int run_index = 0;
  std::set<int> held;
  for (int run : runs) {
    if (run_index++ % kOneHeldBackOf == kOneHeldBackOf / 2) held.insert(run);
  }
  for (std::size_t i = 0; i < held_back.size(); ++i) {
    held_back[i] = held.contains(data.continuous_recording[i]);
  }
  return held_back;
}

HeldBack HoldBack(const FitData& data, int most) {
  HeldBack split;
  std::vector<const Recording*> fit, judged;
  const std::vector<bool> held_back = HeldBackRuns(data);
  for (std::size_t i = 0; i < data.recordings.size(); ++i) {
    (held_back[i] ? judged : fit).push_back(&data.recordings[i]);
  }
  if (judged.empty()) {
    for (const Recording* recording : SpreadEvenly(fit, most)) {
      // a single frame is on both sides
      const bool single = recording->train_frames == 2;
      split.fit.push_back(
          SplitFitFrames(*recording, single ? FrameUse::kFit : FrameUse::kNone, FrameUse::kFit));
      split.judged.push_back(SplitFitFrames(*recording, FrameUse::kHeld, FrameUse::kFit));
    }
    return split;
  }
  for (const Recording* recording : SpreadEvenly(fit, most)) {
    split.fit.push_back(UseFitFrames(*recording, FrameUse::kFit));
  }
  for (const Recording* recording : SpreadEvenly(judged, most)) {
    split.judged.push_back(UseFitFrames(*recording, FrameUse::kHeld));
  }
  return split;
}

HeldBackMotion HoldBackMotion(const FitData& data, int most) {
  HeldBackMotion split;
  const std::vector<bool> held_back = HeldBackRuns(data);
  const bool has_runs = std::find(held_back.begin(), held_back.end(), true) != held_back.end();
  for (std::size_t i = 0; i < data.recordings.size(); ++i) {
    const Recording& recording = data.recordings[i];
    if (has_runs) {
      if (held_back[i]) {
        split.judged.push_back(UseFitFrames(recording, FrameUse::kHeld));
        continue;
      }
      split.fit.recordings.push_back(recording);
    } else {
      // at least one frame is fitted, and one held back where there are two
      const int last = recording.train_frames - 1;
      const int earlier = std::max(1, std::min(last - 1, static_cast<int>(kEarlier * last)));
      split.judged.push_back(UseFitFrames(recording, FrameUse::kHeld));
      for (int frame = 1; frame <= earlier; ++frame)
        split.judged.back().use[frame] = FrameUse::kNone;
      split.fit.recordings.push_back(recording);
      split.fit.recordings.back().train_frames = earlier + 1;
    }
    split.fit.continuous_recording.push_back(data.continuous_recording[i]);
  }
  split.judged = SpreadEvenly(split.judged, most);
  return split;
}

}  // namespace physpring
