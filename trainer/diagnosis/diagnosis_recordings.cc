// SPDX-License-Identifier: Apache-2.0
#include "trainer/diagnosis/diagnosis_recordings.h"

#include "trainer/held_back.h"

namespace physpring {
namespace {

constexpr int kMostRecordings = 4;  // to fit, and to judge by

}  // namespace

DiagnosisRecordings ChooseRecordings(const FitData& data, const std::vector<Recording>& held_out) {
  if (!held_out.empty()) {
    return {SpreadEvenly(data.recordings, kMostRecordings),
            SpreadEvenly(held_out, kMostRecordings)};
  }
  const std::vector<bool> is_held_out = HeldBackRuns(data);
  DiagnosisRecordings all;
  for (std::size_t i = 0; i < data.recordings.size(); ++i) {
    (is_held_out[i] ? all.held_out : all.fit).push_back(data.recordings[i]);
  }
  return {SpreadEvenly(all.fit, kMostRecordings), SpreadEvenly(all.held_out, kMostRecordings)};
}

}  // namespace physpring
