// SPDX-License-Identifier: Apache-2.0
#include "trainer/held_back.h"

#include <algorithm>
#include <limits>
#include <set>

namespace physpring {
namespace {

constexpr int kParts = 8;          // of a recording's fit frames ...
constexpr int kOneHeldBackOf = 4;  // ... of which one in so many is held back

// Whether frame 1 ... `last` is held back.
bool IsHeldBack(int frame, int last) {
  if (last < kParts) return frame == last;
  const int part = (frame - 1) * kParts / last;
  return part % kOneHeldBackOf == kOneHeldBackOf - 1;
}

// A copy in which, of the fit frames, only those that are held back are seen, or all others.
Recording OnlyFrames(const Recording& recording, bool held_back) {
  Recording part = recording;
  const int last = recording.train_frames - 1;
  for (int frame = 1; frame <= last; ++frame) {
    if (last > 1 && IsHeldBack(frame, last) != held_back) {
      part.points[frame].setConstant(std::numeric_limits<double>::quiet_NaN());
    }
  }
  return part;
}

}  // namespace

std::vector<Episode> HeldBack::FitEpisodes() const {
  std::vector<Episode> episodes;
  for (const Recording& recording : fit) episodes.push_back({&recording, recording.train_frames});
  return episodes;
}

std::vector<JudgedEpisode> HeldBack::JudgedEpisodes() const {
  std::vector<JudgedEpisode> episodes;
  for (const Judged& by : judged) {
    episodes.push_back({{by.whole, by.whole->train_frames}, &by.held_back});
  }
  return episodes;
}

std::vector<Episode> FitEpisodes(const FitData& data, int most) {
  std::vector<Episode> episodes;
  for (const Recording& recording : data.recordings) {
    episodes.push_back({&recording, recording.train_frames});
  }
  return SpreadEvenly(episodes, most);
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
      split.fit.push_back(OnlyFrames(*recording, false));
      split.judged.push_back({recording, OnlyFrames(*recording, true)});
    }
    return split;
  }
  for (const Recording* recording : SpreadEvenly(fit, most)) split.fit.push_back(*recording);
  for (const Recording* recording : SpreadEvenly(judged, most)) {
    split.judged.push_back({recording, *recording});
  }
  return split;
}

}  // namespace physpring
