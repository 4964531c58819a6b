// SPDX-License-Identifier: Apache-2.0
#include "rollout/sweep_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "twin/atomic_file.h"
#include "twin/error.h"
#include "twin/json_fields.h"
#include "twin/npz.h"

namespace physpring {
namespace {

namespace fs = std::filesystem;

// Of all that a task is made of. Levels count one by one, so that more may be added later.
std::string HashTask(const Task& task) {
  return HashBytes(ReadFile(task.folder + "/task.json") + ReadFile(task.scene));
}

std::string FormatIdentity(const Task& task, const SweepOptions& options) {
  const nlohmann::ordered_json json = {{"task", task.name},
                                       {"task_hash", HashTask(task)},
                                       {"policy", options.policy.text},
                                       {"seed", options.seed},
                                       {"action_noise", options.action_noise}};
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

}  // namespace

void OpenSweepFolder(const Task& task, const SweepOptions& options) {
  const std::string file = options.folder + "/sweep.json";
  const std::string identity = FormatIdentity(task, options);
  std::error_code failure;
  for (const int level : options.levels) {
    fs::create_directories(fmt::format("{}/level{}", options.folder, level), failure);
    if (failure) {
      throw Error(fmt::format("{}: cannot be made: {}", options.folder, failure.message()));
    }
  }
  if (!fs::exists(file)) return WriteFileAtomically(file, identity);
  if (ReadFile(file) == identity) return;
  const JsonFields now(identity, file), before(ReadFile(file), file);
  for (const char* key : {"task", "task_hash", "policy", "seed", "action_noise"}) {
    const auto value = [key](const JsonFields& fields) {
      return nlohmann::json::parse(fields.Dump()).value(key, nlohmann::json()).dump();
    };
    if (value(now) == value(before)) continue;
    throw Error(fmt::format("{}: holds a sweep with {} {}, not {}; use another folder", file, key,
                            value(before), value(now)));
  }
}

StoredSweep ReadSweepFolder(const std::string& folder) {
  const std::string file = folder + "/sweep.json";
  StoredSweep sweep;
  sweep.identity = ReadFile(file);
  const JsonFields fields(sweep.identity, file);
  sweep.task = fields.Text("task");
  sweep.policy = fields.Text("policy");
  for (const fs::directory_entry& level : fs::directory_iterator(folder)) {
    const int number = NumberIn(level.path().filename().string(), "level", "");
    if (number < 0 || !level.is_directory()) continue;
    for (const fs::directory_entry& entry : fs::directory_iterator(level.path())) {
      const int episode = NumberIn(entry.path().filename().string(), "episode_", ".json");
      if (episode < 0) continue;
      sweep.episodes.push_back(ReadEpisode(folder, number, episode).value());
    }
  }
  std::sort(sweep.episodes.begin(), sweep.episodes.end(), [](const auto& a, const auto& b) {
    return std::pair(a.episode, a.level) < std::pair(b.episode, b.level);
  });
  return sweep;
}

}  // namespace physpring
