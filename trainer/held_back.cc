// SPDX-License-Identifier: Apache-2.0
#include "trainer/held_back.h"

#include <algorithm>
#include <limits>
#include <set>

namespace physpring {
namespace {

constexpr int kParts = 8;          // of a recording's fit frames ...
constexpr int kOneHeldBackOf = 4;  // ... of which one in so many is held back

template <class T>
std::vector<T> SpreadEvenly(const std::vector<T>& all, int most) {
  const int count = static_cast<int>(all.size());
  if (count <= most) return all;
  std::vector<T> some;
  for (int i = 0; i < most; ++i) some.push_back(all[(2 * i + 1) * count / (2 * most)]);
  return some;
}

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

std::vector<Episode> FitEpisodes(const FitData& data, int most) {
  std::vector<Episode> episodes;
  for (const Recording& recording : data.recordings) {
    episodes.push_back({&recording, recording.train_frames});
  }
  return SpreadEvenly(episodes, most);
}

HeldBack HoldBack(const FitData& data, int most) {
  HeldBack split;
  const std::set<int> runs(data.continuous_recording.begin(), data.continuous_recording.end());
  if (runs.size() < kOneHeldBackOf) {
    for (const Episode& episode : FitEpisodes(data, most)) {
      split.fit.push_back(OnlyFrames(*episode.recording, false));
      split.judged.push_back({episode.recording, OnlyFrames(*episode.recording, true)});
    }
    return split;
  }
  int run_index = 0;
  std::set<int> held;
  for (int run : runs) {
    if (run_index++ % kOneHeldBackOf == kOneHeldBackOf / 2) held.insert(run);
  }
  std::vector<const Recording*> fit, judged;
  for (std::size_t i = 0; i < data.recordings.size(); ++i) {
    (held.contains(data.continuous_recording[i]) ? judged : fit).push_back(&data.recordings[i]);
  }
  for (const Recording* recording : SpreadEvenly(fit, most)) split.fit.push_back(*recording);
  for (const Recording* recording : SpreadEvenly(judged, most)) {
    split.judged.push_back({recording, *recording});
  }
  return split;
}

}  // namespace physpring
