// SPDX-License-Identifier: Apache-2.0
#include "jobs/diagnosis_checkpoint.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "jobs/training_code.h"
#include "twin/error.h"
#include "twin/json_text.h"
#include "twin/npz.h"
#include "twin/quote.h"

namespace physpring {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr char kOf[] = "of", kFinishedDiagnosis[] = "finished";

std::vector<std::string> HashesOf(const std::vector<Recording>& recordings) {
  std::vector<std::string> hashes;
  for (const Recording& recording : recordings) hashes.push_back(recording.hash);
  return hashes;
}

// Throws Error unless the file is a checkpoint.
Npz ReadCheckpoint(const std::string& path) {
  Npz arrays = ReadNpz(path);
  for (const char* name : {kOf, kFinishedDiagnosis}) {
    if (!arrays.contains(name)) {
      throw Error(
          fmt::format("{}: is no checkpoint of a diagnosis: array {} is missing", path, name));
    }
  }
  return arrays;
}

// What the diagnosis in the file is of.
Json ReadOf(const Npz& arrays, const std::string& path) {
  const std::string where = fmt::format("{}: array '{}'", path, kOf);
  std::string text;
  try {
    text = arrays.at(kOf).ToText();
  } catch (const Error& error) {
    throw Error(fmt::format("{} {}", where, error.what()));
  }
  return ParseJson(text, where);
}

}  // namespace

DiagnosisCheckpoint::DiagnosisCheckpoint(const std::string& path, const std::string& twin,
                                         const DiagnosisRecordings& recordings,
                                         const DiagnosisOptions& options)
    : path_(path),
      of_json_(Json{{"version", kTrainingCode},
                    {"twin", HashFile(twin)},
                    {"recordings", HashesOf(recordings.fit)},
                    {"held-out recordings", HashesOf(recordings.held_out)},
                    {"recordings before the change", HashesOf(recordings.before)},
                    {"seed", options.seed}}
                   .dump()) {}

void DiagnosisCheckpoint::ExpectReplaceable(const std::string& report, bool allowed) const {
  const bool begun = fs::exists(path_);
  if (allowed || (!begun && !fs::exists(report))) return;
  const bool finished =
      !begun || ReadCheckpoint(path_).at(kFinishedDiagnosis).ToInts() == std::vector<int>{1};
  throw Error(fmt::format("{}: {}", fs::path(path_).parent_path().string(),
                          finished ? "holds a finished diagnosis; --force makes it anew"
                                   : "holds an unfinished diagnosis; --resume goes on with it, "
                                     "--force makes it anew"));
}

void DiagnosisCheckpoint::Resume(Journal* journal) const {
  if (!fs::exists(path_)) return;
  const Npz arrays = ReadCheckpoint(path_);
  const Json in_file = ReadOf(arrays, path_);
  const Json now = ParseJson(of_json_, path_);
  for (const auto& [key, value] : now.items()) {
    const Json before = in_file.is_object() ? in_file.value(key, Json()) : Json();
    if (before == value) continue;
    throw Error(
        fmt::format("{}: is of a diagnosis with {} {}, not {}; resume with what it began "
                    "with",
                    path_, key, Shorten(before.dump()), Shorten(value.dump())));
  }
  try {
    journal->Load(arrays);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", path_, error.what()));
  }
}

void DiagnosisCheckpoint::Write(const Journal& journal) const {
  Npz arrays = journal.Save();
  const int flag = 0;
  arrays[kFinishedDiagnosis] = NpzArray::Ints({}, &flag);
  arrays[kOf] = NpzArray::Text(of_json_);
  WriteNpz(arrays, path_);
}

void DiagnosisCheckpoint::Finish() const {
  Npz arrays = ReadCheckpoint(path_);
  const int flag = 1;
  arrays[kFinishedDiagnosis] = NpzArray::Ints({}, &flag);
  WriteNpz(arrays, path_);
}

}  // namespace physpring
