// SPDX-License-Identifier: Apache-2.0
#include "python/bindings/given_recordings.h"

#include <utility>

#include "twin/clock_offset.h"
#include "twin/error.h"

namespace physpring {

GivenRecording Given(RecordingEntry entry, Npz arrays) {
  GivenRecording given;
  given.arrays = std::move(arrays);
  given.recording = ParseRecording(given.arrays, entry.path);
  given.entry = std::move(entry);
  return given;
}

GivenRecording InMemory(const std::string& name, Npz arrays) {
  RecordingEntry entry;
  entry.path = name + ".npz";
  const std::string bytes = PackNpz(arrays, entry.path);
  GivenRecording given = Given(entry, std::move(arrays));
  given.recording.hash = HashBytes(bytes);  // that of the file, if it is saved
  return given;
}

FitData FitDataOf(const GivenRecordings& given) {
  if (given.empty()) throw Error("no recording is given");
  std::vector<RecordingEntry> entries;
  std::vector<Recording> recordings;
  for (const GivenRecording* one : given) {
    ExpectPoints(one->recording, one->entry.path);
    entries.push_back(one->entry);
    recordings.push_back(one->recording);
  }
  return CollectFitData(entries, std::move(recordings));
}

Recording RecordingFor(const Twin& twin, const GivenRecording& given) {
  ExpectPoints(given.recording, given.entry.path);
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
