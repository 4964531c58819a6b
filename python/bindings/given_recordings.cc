// SPDX-License-Identifier: Apache-2.0
#include "python/bindings/given_recordings.h"

#include <utility>

#include "twin/clock_offset.h"
#include "twin/error.h"

namespace physpring {

FitData FitDataOf(const GivenRecordings& given) {
  if (given.empty()) throw Error("no recording is given");
  std::vector<RecordingEntry> entries;
  std::vector<Recording> recordings;
  for (const GivenRecording* one : given) {
    entries.push_back(one->entry);
    recordings.push_back(one->recording);
  }
  return CollectFitData(entries, std::move(recordings));
}

Recording RecordingFor(const Twin& twin, const GivenRecording& given) {
  Recording recording = given.recording;
  UseClockOf(twin, &recording);
  return recording;
}

void AddNewWarnings(const GivenRecording& given, const Recording& recording,
                    std::vector<std::string>* warnings) {
  const auto before = static_cast<std::ptrdiff_t>(given.recording.warnings.size());
  warnings->insert(warnings->end(), recording.warnings.begin() + before, recording.warnings.end());
}

}  // namespace physpring
