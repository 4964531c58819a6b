// SPDX-License-Identifier: Apache-2.0
#include "cli/checkpoint.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/output_files.h"
#include "cli/train_words.h"
#include "twin/effects/effect_json.h"
#include "twin/error.h"

namespace physpring {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kFinishedTraining = "train/finished";
constexpr const char* kStateVersion = "train/version";
constexpr int kVersion = 1;  // of what fitters save; to be raised with each change of their stages

Json NumberOrAuto(int number) { return number > 0 ? Json(number) : Json("auto"); }

// Everything that the result depends on, but the seed, which has a place of its own. Not the number
// of threads.
std::string OptionsJson(const TrainOptions& options, const std::string& from) {
  Json json;
  json["method"] = WordOf(kMethodWords, options.method);
  json["optimizer"] = WordOf(kOptimizerWords, options.optimizer);
  json["levels"] = options.levels;
  if (options.levels > 1) {
    json["ratios"] =
        std::vector<double>(options.ratios.begin(), options.ratios.begin() + options.levels - 1);
    json["reduction"] = WordOf(kReductionWords, options.reduction);
    json["latent"] = options.network.latent;
    json["network_epochs"] = options.network.epochs;
    json["network_updates"] = options.network.updates;
    json["contact_updates"] = options.network.contact_updates;
    json["features"] = WordOf(kFeatureWords, options.network.features);
  }
  if (!from.empty()) json["from"] = from;
  if (!options.effects.empty()) json["effects"] = Json::parse(EffectsToJson(options.effects));
  json["neighbours"] = options.neighbours.empty() ? Json("auto") : Json(options.neighbours);
  json["epochs"] = NumberOrAuto(options.epochs);
  json["substeps"] = NumberOrAuto(options.substeps);
  json["precision"] = WordOf(kPrecisionWords, options.single_precision);
  json["controller_velocity"] = WordOf(kVelocityWords, options.controller_velocity);
  json["cone"] = WordOf(kConeWords, options.cone);
  json["self_collision"] = options.self_collision ? "on" : "off";
  return json.dump();
}

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

void WarnIfUnfinished(const Twin& twin, const std::string& path) {
  if (IsFinished(twin)) return;
  fmt::print(stderr,
             "warning: {}: its training is not finished; `physpring train` with --resume goes on\n",
             path);
}

Checkpoint::Checkpoint(const std::string& path, const FitData& data, const TrainOptions& options,
                       const std::string& from)
    : path_(path) {
  labels_.name = NameOfTwin(path);
  for (const Recording& recording : data.recordings) {
    labels_.trained_on.push_back({recording.name, recording.hash, recording.train_frames});
  }
  labels_.options_json = OptionsJson(options, from);
  labels_.seed = options.seed;
}

void Checkpoint::ExpectReplaceable(bool force) const {
  if (!Exists(path_)) return;
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
                    path_, what, in_file, now));
  };
  const Json in_file = Json::parse(twin.options_json), now = Json::parse(labels_.options_json);
  Json keys = in_file;  // and those that are new
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

void Checkpoint::Resume(Fitter* fitter) const {
  if (!Exists(path_)) return;
  const Twin twin = ReadTwin(path_);
  ExpectSameTraining(twin);
  const auto version = twin.training_state.find(kStateVersion);
  if (version == twin.training_state.end() ||
      version->second.ToInts() != std::vector<int>{kVersion}) {
    throw Error(fmt::format(
        "{}: its training was begun by another version of physpring; --force trains it anew",
        path_));
  }
  try {
    fitter->Load(twin.training_state);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", path_, error.what()));
  }
}

Twin Checkpoint::Write(const Fitter& fitter, bool finished) const {
  Twin twin = fitter.Result();
  twin.name = labels_.name;
  twin.trained_on = labels_.trained_on;
  twin.options_json = labels_.options_json;
  twin.seed = labels_.seed;
  twin.training_state = fitter.Save();
  const int flag = finished ? 1 : 0;
  twin.training_state[kFinishedTraining] = NpzArray::Ints({}, &flag);
  twin.training_state[kStateVersion] = NpzArray::Ints({}, &kVersion);
  WriteTwin(twin, path_);
  return twin;
}

}  // namespace physpring
