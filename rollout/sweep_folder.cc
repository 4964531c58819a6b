// SPDX-License-Identifier: Apache-2.0
#include "rollout/sweep_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "twin/atomic_file.h"
#include "twin/draft_file.h"
#include "twin/error.h"
#include "twin/json_fields.h"
#include "twin/json_text.h"
#include "twin/npz.h"
#include "twin/quote.h"

namespace physpring {
namespace {

namespace fs = std::filesystem;

std::string FormatIdentity(const Task& task, const SweepOptions& options) {
  nlohmann::ordered_json json = {{"task", task.name},
                                 {"task_hash", HashFile(task.folder + "/task.json")},
                                 {"policy", options.policy.text},
                                 {"seed", options.seed},
                                 {"action_noise", options.disturbance.action},
                                 {"perturb", options.disturbance.start}};
  const std::string adapter = AdapterOf(task, options.policy);
  if (!adapter.empty()) json["policy_adapter_hash"] = HashFile(adapter);
  if (options.vary_looks) json["vary_looks"] = true;
  return json.dump(1) + "\n";
}

// The whole number between `before` and `after` in `name`, or -1.
int NumberIn(std::string_view name, std::string_view before, std::string_view after) {
  if (!name.starts_with(before) || !name.ends_with(after)) return -1;
  if (name.size() <= before.size() + after.size()) return -1;
  const std::string_view digits =
      name.substr(before.size(), name.size() - before.size() - after.size());
  int number = 0;
  const auto [rest, failure] = std::from_chars(digits.begin(), digits.end(), number);
  return failure == std::errc() && rest == digits.end() ? number : -1;
}

// Calls `use` with the level and the number of each episode that is finished.
template <class Use>
void ForEachFinished(const std::string& folder, const Use& use) {
  for (const fs::directory_entry& level : fs::directory_iterator(folder)) {
    const int number = NumberIn(level.path().filename().string(), "level", "");
    if (number < 0 || !level.is_directory()) continue;
    for (const fs::directory_entry& entry : fs::directory_iterator(level.path())) {
      const int episode = NumberIn(entry.path().filename().string(), "episode_", ".json");
      if (episode >= 0) use(number, episode);
    }
  }
}

bool HoldsEpisodes(const std::string& folder) {
  bool found = false;
  ForEachFinished(folder, [&](int, int) { found = true; });
  return found;
}

// Writes what a file has to hold where there is none; otherwise, whether it holds that.
bool IsNewOrHolds(const std::string& file, const std::string& text) {
  if (fs::exists(file)) return ReadFile(file) == text;
  WriteFileAtomically(file, text);
  return true;
}

}  // namespace

void OpenSweepFolder(const Task& task, const SweepOptions& options,
                     const std::map<int, std::string>& hashes) {
  const std::string file = options.folder + "/sweep.json";
  const std::string identity = FormatIdentity(task, options);
  if (!fs::exists(file) && HoldsEpisodes(options.folder)) {
    throw Error(fmt::format(
        "{}: is missing, so nobody knows of what the episodes beside it are; use another folder",
        file));
  }
  RemoveAbandonedDraftsIn(options.folder);
  for (const auto& [level, hash] : hashes) {
    const std::string folder = fmt::format("{}/level{}", options.folder, level);
    MakeFolder(folder);
    RemoveAbandonedDraftsIn(folder);
    if (IsNewOrHolds(folder + "/model.txt", hash + "\n")) continue;
    throw Error(
        fmt::format("{}: holds episodes of another version of the scene or of its object; "
                    "use another folder",
                    folder));
  }
  if (IsNewOrHolds(file, identity)) return;
  const JsonFields now(identity, file), before = ReadJsonFile(file);
  for (const char* key : {"task", "task_hash", "policy", "seed", "action_noise", "perturb",
                          "policy_adapter_hash", "vary_looks"}) {
    const auto value = [key](const JsonFields& fields) {
      return fields.json().value(key, nlohmann::ordered_json());
    };
    if (value(now) == value(before)) continue;
    throw Error(fmt::format("{}: holds a sweep with {} {}, not {}; use another folder", file, key,
                            Shorten(value(before).dump()), Shorten(value(now).dump())));
  }
}

StoredSweep ReadSweepFolder(const std::string& folder) {
  const std::string file = folder + "/sweep.json";
  StoredSweep sweep;
  sweep.identity = ReadFile(file, JsonLimits::kBytes);
  const JsonFields fields(sweep.identity, file);
  sweep.task = fields.Text("task");
  sweep.policy = fields.Text("policy");
  ForEachFinished(folder, [&](int level, int episode) {
    sweep.episodes.push_back(ReadEpisode(folder, level, episode).value());
  });
  std::sort(sweep.episodes.begin(), sweep.episodes.end(), [](const auto& a, const auto& b) {
    return std::pair(a.episode, a.level) < std::pair(b.episode, b.level);
  });
  return sweep;
}

}  // namespace physpring
