// SPDX-License-Identifier: Apache-2.0
#include "trainer/held_back.h"

#include <algorithm>
#include <set>

namespace physpring {
namespace {

template <class T>
std::vector<T> SpreadEvenly(const std::vector<T>& all, int most) {
  const int count = static_cast<int>(all.size());
  if (count <= most) return all;
  std::vector<T> some;
  for (int i = 0; i < most; ++i) some.push_back(all[(2 * i + 1) * count / (2 * most)]);
  return some;
}

}  // namespace

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
  if (runs.size() >= 4) {
    int run_index = 0;
    std::set<int> held;
    for (int run : runs) {
      if (run_index++ % 4 == 2) held.insert(run);
    }
    for (std::size_t i = 0; i < data.recordings.size(); ++i) {
      const Recording& recording = data.recordings[i];
      if (held.contains(data.continuous_recording[i])) {
        split.scored.push_back({&recording, 1, recording.train_frames});
      } else {
        split.fit.push_back({&recording, recording.train_frames});
      }
    }
  } else {
    for (const Recording& recording : data.recordings) {
      const int frames = std::max(2, 1 + 3 * (recording.train_frames - 1) / 4);
      split.fit.push_back({&recording, frames});
      split.scored.push_back(
          {&recording, std::min(frames, recording.train_frames - 1), recording.train_frames});
    }
  }
  split.fit = SpreadEvenly(split.fit, most);
  split.scored = SpreadEvenly(split.scored, most);
  return split;
}

}  // namespace physpring
