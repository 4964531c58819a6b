// SPDX-License-Identifier: Apache-2.0
#include "jobs/checkpoint.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "jobs/train_options_json.h"
#include "jobs/training_code.h"
#include "twin/error.h"
#include "twin/json_text.h"
#include "twin/quote.h"

namespace physpring {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kFinishedTraining = "train/finished";
constexpr const char* kCode = "train/code";      // a hash of the code that trained
constexpr const char* kJournal = "train/kept/";  // the prefix of a journal's arrays

// "a/rope.twin.npz" -> "rope"
std::string NameOfTwin(const std::string& path) {
  std::string name = fs::path(path).filename().string();
  for (const char* extension : {".npz", ".twin"}) {
    if (name.ends_with(extension)) name.resize(name.size() - std::string(extension).size());
  }
  return name;
}

}  // namespace

bool IsFinished(const Twin& twin) {
  const auto finished = twin.training_state.find(kFinishedTraining);
  return finished == twin.training_state.end() || finished->second.ToInts() == std::vector<int>{1};
}

Checkpoint::Checkpoint(const std::string& path, const FitData& data, const TrainOptions& options,
                       const std::string& from)
    : path_(path) {
  labels_.name = NameOfTwin(path);
  for (const Recording& recording : data.recordings) {
    labels_.trained_on.push_back({recording.name, recording.hash, recording.train_frames});
  }
  labels_.options_json = TrainOptionsJson(options, from);
  labels_.seed = options.seed;
}

bool Checkpoint::IsFile() const { return !path_.empty() && fs::exists(path_); }

void Checkpoint::ExpectReplaceable(bool force) const {
  if (!IsFile()) return;
  Twin twin;
  try {
    twin = ReadTwin(path_);
  } catch (const Error& error) {
    throw Error(
        fmt::format("{}: is there and no twin ({}); choose another name", path_, error.what()));
  }
  if (force) return;
  throw Error(fmt::format("{}: {}", path_,
                          IsFinished(twin)
                              ? "is a finished twin; --force trains it anew"
                              : "is an unfinished twin; --resume goes on with it, --force trains "
                                "it anew"));
}

void Checkpoint::ExpectSameTraining(const Twin& twin) const {
  const auto expect_same = [&](const std::string& what, const auto& in_file, const auto& now) {
    if (in_file == now) return;
    throw Error(
        fmt::format("{}: was trained with {} {}, not {}; resume with what it was trained "
                    "with",
                    path_, Shorten(what), Shorten(fmt::format("{}", in_file)),
                    Shorten(fmt::format("{}", now))));
  };
  const Json in_file = ParseJson(twin.options_json, path_ + ": options");
  const Json now = ParseJson(labels_.options_json, "options");
  Json keys = in_file;  // the keys of the file, and below those that are new
  keys.update(now);
  for (const auto& [key, value] : keys.items()) {
    expect_same(key, in_file.value(key, Json()).dump(), now.value(key, Json()).dump());
  }
  expect_same("seed", twin.seed, labels_.seed);
  expect_same("number of recordings", twin.trained_on.size(), labels_.trained_on.size());
  for (std::size_t i = 0; i < labels_.trained_on.size(); ++i) {
    const TrainedOn &before = twin.trained_on[i], &here = labels_.trained_on[i];
    if (before.hash == here.hash) continue;
    throw Error(
        fmt::format("{}: recording {} was {} with hash {}, not {} with hash {}; resume "
                    "with the recordings it was trained on",
                    path_, i + 1, before.name, before.hash, here.name, here.hash));
  }
}

std::optional<Twin> Checkpoint::Resume(Journal* journal) const {
  if (!IsFile()) return {};
  Twin twin = ReadTwin(path_);
  ExpectSameTraining(twin);
  const auto code = twin.training_state.find(kCode);
  if (code == twin.training_state.end() || code->second.ToText() != kTrainingCode) {
    throw Error(fmt::format(
        "{}: its training was begun by another version of physpring; --force trains it anew",
        path_));
  }
  if (IsFinished(twin)) return twin;
  Journal::Arrays kept;
  for (const auto& [name, array] : twin.training_state) {
    if (name.starts_with(kJournal)) kept[name.substr(std::string(kJournal).size())] = array;
  }
  try {
    journal->Load(kept);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: cannot resume: {}", path_, error.what()));
  }
  return twin;
}

PieceKey Checkpoint::Key() const {
  PieceKey key("training");
  key.Add(kTrainingCode).Add(labels_.options_json).Add(static_cast<double>(labels_.seed));
  for (const TrainedOn& recording : labels_.trained_on) key.Add(recording.hash);
  return key;
}

Twin Checkpoint::Labelled(const Twin& twin, bool finished) const {
  Twin labelled = twin;
  labelled.name = labels_.name;
  labelled.trained_on = labels_.trained_on;
  labelled.options_json = labels_.options_json;
  labelled.seed = labels_.seed;
  const int flag = finished ? 1 : 0;
  labelled.training_state = {{kFinishedTraining, NpzArray::Ints({}, &flag)},
                             {kCode, NpzArray::Text(kTrainingCode)}};
  return labelled;
}

Twin Checkpoint::Write(const Twin& so_far, const Journal& journal) const {
  Twin twin = Labelled(so_far, false);
  for (const auto& [name, array] : journal.Save()) twin.training_state[kJournal + name] = array;
  if (!path_.empty()) WriteTwin(twin, path_);
  return twin;
}

Twin Checkpoint::WriteFinished(const Twin& twin) const {
  const Twin labelled = Finished(twin);
  if (!path_.empty()) WriteTwin(labelled, path_);
  return labelled;
}

}  // namespace physpring
