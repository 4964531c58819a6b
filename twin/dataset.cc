// SPDX-License-Identifier: Apache-2.0
#include "twin/dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "twin/error.h"
#include "twin/json_fields.h"
#include "twin/quote.h"

namespace physpring {
namespace {

namespace fs = std::filesystem;

const char* NameOfRole(Role role) { return role == Role::kFit ? "fit" : "heldout"; }

// One element of `recordings`; `folder` is where its file lies.
RecordingEntry ReadEntry(const JsonFields& fields, const fs::path& folder) {
  fields.ExpectOnly({"file", "role", "continuous_recording"});
  RecordingEntry entry;
  entry.path = (folder / fields.Text("file")).string();
  std::error_code missing;
  if (!fs::is_regular_file(entry.path, missing)) {
    fields.Fail("file", fmt::format("holds {}, which is not there", Quote(fields.Text("file"))));
  }
  const std::string role = fields.Text("role");
  if (role != "fit" && role != "heldout") {
    fields.Fail("role", fmt::format("holds {}, expected 'fit' or 'heldout'", Quote(role)));
  }
  entry.heldout = role == "heldout";
  if (fields.Has("continuous_recording")) {
    entry.continuous_recording = fields.Count("continuous_recording");
  }
  return entry;
}

std::vector<RecordingEntry> ReadDataset(const fs::path& folder) {
  const std::string path = (folder / "dataset.json").string();
  const JsonFields fields = ReadJsonFile(path);
  const bool published_l1 = fields.Has("published_l1_m");
  std::vector<RecordingEntry> entries;
  for (const JsonFields& recording : fields.Objects("recordings")) {
    entries.push_back(ReadEntry(recording, folder));
    entries.back().published_l1 = published_l1;
  }
  return entries;
}

std::vector<RecordingEntry> RecordingsOfRole(const fs::path& folder, Role role) {
  std::vector<RecordingEntry> entries = ReadDataset(folder);
  std::erase_if(entries, [role](const RecordingEntry& entry) {
    return entry.heldout != (role == Role::kHeldout);
  });
  if (!entries.empty()) return entries;
  throw Error(fmt::format("{}: key 'recordings' has none of the role '{}'",
                          (folder / "dataset.json").string(), NameOfRole(role)));
}

// A file given by itself; what the dataset.json beside it says of it, if there is one, holds.
RecordingEntry SingleRecording(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  RecordingEntry single;
  std::error_code missing;
  if (fs::exists(folder / "dataset.json", missing)) {
    for (const RecordingEntry& entry : ReadDataset(folder)) {
      if (fs::equivalent(entry.path, path, missing)) single = entry;
    }
  }
  single.path = path;
  return single;
}

// The same file twice would count twice in every mean.
void ExpectDistinct(const std::vector<RecordingEntry>& entries) {
  std::vector<std::string> paths;
  for (const RecordingEntry& entry : entries) {
    std::error_code missing;
    paths.push_back(fs::weakly_canonical(entry.path, missing).string());
  }
  std::sort(paths.begin(), paths.end());
  const auto twice = std::adjacent_find(paths.begin(), paths.end());
  if (twice == paths.end()) return;
  throw Error(fmt::format("{}: is given twice, expected each recording once", *twice));
}

}  // namespace

std::vector<RecordingEntry> ListRecordings(const std::vector<std::string>& arguments, Role role) {
  std::vector<RecordingEntry> entries;
  for (const std::string& argument : arguments) {
    std::error_code missing;
    const bool names_dataset = fs::path(argument).filename() == "dataset.json";
    const fs::path folder = names_dataset ? fs::path(argument).parent_path() : fs::path(argument);
    if (names_dataset || fs::is_directory(folder, missing)) {
      const std::vector<RecordingEntry> listed = RecordingsOfRole(folder, role);
      entries.insert(entries.end(), listed.begin(), listed.end());
    } else if (fs::exists(argument, missing)) {
      entries.push_back(SingleRecording(argument));
    } else {
      throw Error(
          fmt::format("{}: does not exist, expected a recording (.npz) or a folder with a "
                      "dataset.json",
                      argument));
    }
  }
  ExpectDistinct(entries);
  return entries;
}

}  // namespace physpring
