// SPDX-License-Identifier: Apache-2.0
#include "jobs/training_recordings.h"

#include <filesystem>
#include <optional>
#include <set>

#include "twin/clock_offset.h"
#include "twin/npz.h"

namespace physpring {
namespace {

namespace fs = std::filesystem;

// The recording at `path`, if it is this one.
std::optional<Recording> ReadIfSame(const Twin& twin, const fs::path& path,
                                    const TrainedOn& trained) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored) || HashFile(path.string()) != trained.hash) return {};
  return ReadRecordingFor(twin, path.string());
}

}  // namespace

std::vector<Recording> FindTrainingRecordings(const Twin& twin,
                                              const std::vector<std::string>& files) {
  std::set<fs::path> folders;
  for (const std::string& file : files) {
    folders.insert(fs::is_directory(file) ? fs::path(file) : fs::path(file).parent_path());
  }
  std::vector<Recording> found;
  for (const TrainedOn& trained : twin.trained_on) {
    for (const fs::path& folder : folders) {
      auto recording = ReadIfSame(twin, folder / (trained.name + ".npz"), trained);
      if (!recording) continue;
      found.push_back(std::move(*recording));
      break;
    }
  }
  return found;
}

}  // namespace physpring
