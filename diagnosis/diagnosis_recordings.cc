// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/diagnosis_recordings.h"

#include <algorithm>

#include "trainer/data/held_back.h"

namespace physpring {
namespace {

constexpr int kMostOnASide = 4, kEnoughFrames = 1000;  // on each side: to fit, and to judge by

// Some of the recordings, spread evenly.
std::vector<Recording> Some(const std::vector<Recording>& recordings) {
  int longest = 1;
  for (const Recording& recording : recordings) {
    longest = std::max(longest, recording.frame_count());
  }
  return SpreadEvenly(recordings, std::clamp(kEnoughFrames / longest, 1, kMostOnASide));
}

}  // namespace

DiagnosisRecordings ChooseRecordings(const FitData& data, const std::vector<Recording>& held_out,
                                     const std::vector<Recording>& before) {
  if (!held_out.empty()) return {Some(data.recordings), Some(held_out), Some(before)};
  const std::vector<bool> is_held_out = HeldBackRuns(data);
  DiagnosisRecordings all;
  for (std::size_t i = 0; i < data.recordings.size(); ++i) {
    (is_held_out[i] ? all.held_out : all.fit).push_back(data.recordings[i]);
  }
  return {Some(all.fit), Some(all.held_out), Some(before)};
}

}  // namespace physpring
