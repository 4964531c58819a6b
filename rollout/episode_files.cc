// SPDX-License-Identifier: Apache-2.0
#include "rollout/episode_files.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "twin/atomic_file.h"
#include "twin/error.h"
#include "twin/json_fields.h"
#include "twin/npz.h"

namespace physpring {
namespace {

using Json = nlohmann::ordered_json;

Json ToJson(const Eigen::VectorXd& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

Json ToJson(const Pose& pose) {
  const Eigen::Quaterniond& q = pose.orientation;
  return {{"position", ToJson(pose.position)}, {"quaternion", {q.w(), q.x(), q.y(), q.z()}}};
}

// `hash`: of the file with states and actions.
std::string FormatVerdict(const TaskEpisode& episode, const std::string& hash) {
  const EpisodeSummary summary = Summarise({episode, {}});
  const Json json = {{"episode", summary.episode},
                     {"level", summary.level},
                     {"start", ToJson(episode.start.object)},
                     {"action_offset", ToJson(episode.start.action_offset)},
                     {"seed", episode.start.seed},
                     {"frames", summary.frames},
                     {"success", summary.success},
                     {"met_frames", summary.met_frames},
                     {"value", summary.value},
                     {"problem", summary.problem},
                     {"npz_hash", hash}};
  return json.dump(1) + "\n";
}

std::string FormatSeconds(const EpisodeSeconds& seconds) {
  const Json json = {{"physics", seconds.physics},
                     {"policy", seconds.policy},
                     {"scoring", seconds.scoring},
                     {"rendering", seconds.rendering},
                     {"total", seconds.total}};
  return json.dump() + "\n";
}

// Rows of equal length as (rows, length).
NpzArray Table(const std::vector<Eigen::VectorXd>& rows) {
  const std::size_t columns = rows.empty() ? 0 : static_cast<std::size_t>(rows[0].size());
  std::vector<double> values;
  for (const Eigen::VectorXd& row : rows) {
    values.insert(values.end(), row.data(), row.data() + row.size());
  }
  return NpzArray::Doubles({rows.size(), columns}, values.data());
}

NpzArray Path(const std::vector<Points>& frames) {
  const std::size_t nodes = frames.empty() ? 0 : static_cast<std::size_t>(frames[0].cols());
  std::vector<double> values;
  values.reserve(3 * nodes * frames.size());
  for (const Points& points : frames) {
    values.insert(values.end(), points.data(), points.data() + points.size());
  }
  return NpzArray::Doubles({frames.size(), nodes, 3}, values.data());
}

Npz Arrays(const TaskEpisode& episode, bool states) {
  Npz arrays;
  arrays["actions"] = Table(episode.actions);
  arrays["value"] = NpzArray::Doubles({episode.value.size()}, episode.value.data());
  if (!states) return arrays;
  arrays["robot"] = Table(episode.robot);
  arrays["nodes"] = Path(episode.nodes);
  return arrays;
}

// Nothing where they are missing or damaged: no result depends on them.
std::optional<EpisodeSeconds> ReadSeconds(const std::string& file) {
  try {
    const JsonFields fields(ReadFile(file), file);
    return EpisodeSeconds{fields.Number("physics"), fields.Number("policy"),
                          fields.Number("scoring"), fields.Number("rendering"),
                          fields.Number("total")};
  } catch (const Error&) {
    return std::nullopt;
  }
}

// Throws Error unless the file with states and actions is the one of the verdict.
void ExpectSound(const std::string& file, const JsonFields& verdict) {
  if (!verdict.Has("npz_hash")) {  // of a version that did not know the hash
    ReadNpz(file);
    return;
  }
  const std::string hash = HashFile(file);
  if (hash != verdict.Text("npz_hash")) {
    throw Error(fmt::format("{}: is damaged: its hash is not the one in the verdict", file));
  }
}

}  // namespace

EpisodeSummary Summarise(const EpisodeResult& result) {
  const TaskEpisode& episode = result.episode;
  EpisodeSummary summary;
  summary.episode = episode.start.episode;
  summary.level = episode.level;
  summary.frames = static_cast<int>(episode.value.size());
  summary.success = episode.success;
  summary.met_frames = episode.met_frames;
  summary.value = episode.value.empty() ? 0 : episode.value.back();
  summary.problem = episode.problem;
  summary.seconds = result.seconds;
  return summary;
}

std::string EpisodePath(const std::string& folder, int level, int episode) {
  return fmt::format("{}/level{}/episode_{:05}", folder, level, episode);
}

void WriteEpisode(const std::string& folder, const EpisodeResult& result, bool states) {
  const TaskEpisode& episode = result.episode;
  const std::string path = EpisodePath(folder, episode.level, episode.start.episode);
  const std::string bytes = PackNpz(Arrays(episode, states), path + ".npz");
  WriteFileAtomically(path + ".npz", bytes);
  WriteFileAtomically(path + ".seconds.json", FormatSeconds(result.seconds));
  WriteFileAtomically(path + ".json", FormatVerdict(episode, HashBytes(bytes)));
}

std::optional<EpisodeSummary> ReadEpisode(const std::string& folder, int level, int episode) {
  const std::string path = EpisodePath(folder, level, episode), file = path + ".json";
  if (!std::filesystem::exists(file)) return std::nullopt;
  const JsonFields fields = ReadJsonFile(file);
  EpisodeSummary summary;
  summary.episode = fields.Count("episode");
  summary.level = fields.Count("level");
  if (summary.episode != episode || summary.level != level) {
    throw Error(
        fmt::format("{}: is of level {}, episode {}", file, summary.level, summary.episode));
  }
  summary.frames = fields.Count("frames");
  summary.success = fields.Flag("success");
  summary.met_frames = fields.Count("met_frames");
  summary.value = fields.Number("value");
  summary.problem = fields.Text("problem");
  summary.seconds = ReadSeconds(path + ".seconds.json");
  ExpectSound(path + ".npz", fields);
  return summary;
}

}  // namespace physpring
