// SPDX-License-Identifier: Apache-2.0
#include "report/eval_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "twin/atomic_file.h"
#include "twin/error.h"
#include "twin/npz_fields.h"

namespace physpring {
namespace {

using Json = nlohmann::ordered_json;

// Which columns a table has beside the prediction's.
struct Columns {
  bool fit, lifted, published;
  std::size_t name;  // its width
};

Columns ColumnsOf(const std::vector<Row>& rows) {
  std::size_t name = 10;
  for (const Row& row : rows) name = std::max(name, row.name.size());
  return {
      rows[0].fit.has_value(),
      std::count_if(rows.begin(), rows.end(), [](const Row& row) { return row.level >= 0; }) > 1,
      rows[0].published_l1.has_value(), name};
}

// The two or four numbers of one part.
std::string FormatErrors(const RowErrors& errors, bool lifted) {
  std::string line =
      fmt::format(" {:>8} {:>8}", Millimetres(errors.cd.value), Millimetres(errors.track.value));
  if (lifted) {
    line += fmt::format(" {:>8} {:>8}", Millimetres(errors.cd_lifted.value),
                        Millimetres(errors.track_lifted.value));
  }
  return line;
}

std::string FormatRow(const Row& row, const Columns& columns) {
  std::string line = fmt::format("{:<{}}", row.name, columns.name);
  if (row.level >= 0) {
    line += fmt::format(" {:>6} {:>8} {:>9} {:>8.0f}", row.nodes, row.springs, row.substeps,
                        row.frames_per_second);
  } else {
    line += fmt::format("{:35}", "");
  }
  if (columns.fit) {
    line += " |" + (row.fit ? FormatErrors(*row.fit, columns.lifted)
                            : fmt::format("{:{}}", "", columns.lifted ? 36 : 18));
  }
  line += " |" + FormatErrors(row.prediction, columns.lifted);
  if (columns.published) line += fmt::format(" | {:>8}", Millimetres(row.published_l1));
  return line + "\n";
}

// Two lines: the first names the parts, the second the columns of each part.
std::string FormatHead(const Columns& columns) {
  const int width = columns.lifted ? 35 : 17;
  std::string parts = fmt::format("{:<{}}", "errors in mm", columns.name + 35);
  std::string names = fmt::format("{:<{}} {:>6} {:>8} {:>9} {:>8}", "", columns.name, "nodes",
                                  "springs", "sub-steps", "FPS");
  const std::string errors = columns.lifted ? fmt::format(" | {:>8} {:>8} {:>8} {:>8}", "CD",
                                                          "track", "lift. CD", "l. track")
                                            : fmt::format(" | {:>8} {:>8}", "CD", "track");
  if (columns.fit) {
    parts += fmt::format(" | {:<{}}", "fit", width);
    names += errors;
  }
  names += errors;
  if (columns.published) {
    parts += fmt::format(" | {:<{}} |   DEFORM", "prediction", width);
    names += " |       L1";
  } else {
    parts += " | prediction";
  }
  return parts + "\n" + names + "\n";
}

std::string FormatRows(const std::vector<Row>& rows, const Columns& columns) {
  std::string text;
  for (const Row& row : rows) text += FormatRow(row, columns);
  const Row& still = rows.back();
  const int without_data = still.prediction.track.frames_without_data +
                           (still.fit ? still.fit->track.frames_without_data : 0);
  if (without_data > 0) {
    text +=
        fmt::format("({} frames in which no tracked point is seen are left out)\n", without_data);
  }
  return text;
}

std::string DescribeFrames(const EvaluatedRecording& evaluated) {
  const int frames = evaluated.recording.frame_count();
  const int split = evaluated.result.first_predicted;
  std::string text = fmt::format("{} frames at {:g} fps", frames, evaluated.recording.fps);
  if (!evaluated.result.trained_on) return text + ", not seen in training";
  text += fmt::format(", frames 0-{} seen in training", split - 1);
  return text;
}

Json Nullable(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json ToJson(const RowErrors& errors, bool is_baseline) {
  Json json = {{"cd", Nullable(errors.cd.value)},
               {"track", Nullable(errors.track.value)},
               {"cd_euclidean", Nullable(errors.cd_euclidean.value)}};
  if (!is_baseline) {
    json["cd_lifted"] = Nullable(errors.cd_lifted.value);
    json["track_lifted"] = Nullable(errors.track_lifted.value);
    json["cd_euclidean_lifted"] = Nullable(errors.cd_euclidean_lifted.value);
  }
  json["frames"] = {{"cd", errors.cd.frames}, {"track", errors.track.frames}};
  json["frames_without_data"] = {{"cd", errors.cd.frames_without_data},
                                 {"track", errors.track.frames_without_data}};
  return json;
}

Json ToJson(const Row& row) {
  Json json = Json::object();
  const bool is_baseline = row.level < 0;
  if (!is_baseline) {
    json = {{"level", row.level},
            {"nodes", row.nodes},
            {"springs", row.springs},
            {"substeps", row.substeps},
            {"fps", row.frames_per_second}};
  }
  json["fit"] = row.fit ? ToJson(*row.fit, is_baseline) : Json(nullptr);
  json["prediction"] = ToJson(row.prediction, is_baseline);
  if (row.published_l1) json["published_l1"] = *row.published_l1;
  return json;
}

// {"levels": [...], "motionless": {...}, ...} added to `json`.
void AddRows(const std::vector<Row>& rows, Json* json) {
  (*json)["levels"] = Json::array();
  for (const Row& row : rows) {
    if (row.level >= 0) {
      (*json)["levels"].push_back(ToJson(row));
    } else {
      (*json)[row.name] = ToJson(row);
    }
  }
}

std::string FormatAnchored(const Evaluation& evaluation) {
  std::string text = fmt::format(
      "\nafter frame {}, track in mm: predicted from frame 0 on, and anew from what is "
      "tracked in frame {}\n{:<10} {:>8} {:>8}\n",
      evaluation.anchor, evaluation.anchor, "", "frame 0", "anew");
  for (const EvaluatedRecording& evaluated : evaluation.recordings) {
    text += evaluated.path + "\n";
    for (const AnchoredRow& row : AnchoredRowsOf(evaluated, evaluation.anchor)) {
      text += fmt::format("{:<10} {:>8} {:>8}\n", row.name, Millimetres(row.blind),
                          Millimetres(row.anchored));
    }
  }
  return text;
}

Json AnchoredAsJson(const EvaluatedRecording& evaluated, int anchor) {
  Json json = {{"frame", anchor}};
  for (const AnchoredRow& row : AnchoredRowsOf(evaluated, anchor)) {
    json[row.name] = {{"track_from_start", Nullable(row.blind)},
                      {"track_from_anchor", Nullable(row.anchored)}};
  }
  return json;
}

Npz TrajectoryOf(const EvaluatedRecording& evaluated) {
  Npz arrays;
  for (const LevelResult& level : evaluated.result.levels) {
    arrays[fmt::format("level{}/points", level.level)] = StoreFrames(level.points);
  }
  return arrays;
}

}  // namespace

std::string Millimetres(const std::optional<double>& metres) {
  return metres ? fmt::format("{:.2f}", 1e3 * *metres) : "-";
}

std::string FormatTables(const Evaluation& evaluation) {
  const std::vector<Row> means = MeanRows(evaluation);
  const Columns columns = ColumnsOf(means);
  const std::size_t levels = evaluation.twin.levels.size();
  std::string text =
      fmt::format("{}: {} {}, {} precision\n\n{}", evaluation.twin_path, levels,
                  levels == 1 ? "level" : "levels",
                  evaluation.single_precision ? "single" : "double", FormatHead(columns));
  for (const EvaluatedRecording& evaluated : evaluation.recordings) {
    text += fmt::format("{}: {}\n{}", evaluated.path, DescribeFrames(evaluated),
                        FormatRows(RowsOf(evaluated), columns));
    if (evaluated.images) text += "\n" + FormatImageTable(evaluated);
  }
  const std::size_t recordings = evaluation.recordings.size();
  if (recordings > 1) {
    text += fmt::format("mean over {} recordings\n{}", recordings, FormatRows(means, columns));
  }
  if (evaluation.anchor > 0) text += FormatAnchored(evaluation);
  return text;
}

std::string FormatJson(const Evaluation& evaluation) {
  Json json = {{"twin", evaluation.twin_path},
               {"precision", evaluation.single_precision ? "float" : "double"}};
  AddRows(MeanRows(evaluation), &json);
  json["recordings"] = Json::array();
  for (const EvaluatedRecording& evaluated : evaluation.recordings) {
    Json recording = {{"file", evaluated.path},
                      {"trained_on", evaluated.result.trained_on},
                      {"frames", evaluated.recording.frame_count()},
                      {"first_predicted", evaluated.result.first_predicted}};
    AddRows(RowsOf(evaluated), &recording);
    if (evaluated.anchored) {
      recording["anchored"] = AnchoredAsJson(evaluated, evaluation.anchor);
    }
    if (evaluated.images) recording["images"] = ImagesAsJson(evaluated);
    json["recordings"].push_back(recording);
  }
  // a file name need not be UTF-8
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

void WriteTrajectories(const Evaluation& evaluation, const std::string& path) {
  if (path.ends_with(".npz")) {
    if (evaluation.recordings.size() != 1) {
      throw Error(fmt::format("{}: is one file, but there are {} recordings; give a folder", path,
                              evaluation.recordings.size()));
    }
    WriteNpz(TrajectoryOf(evaluation.recordings[0]), path);
    return;
  }
  std::set<std::string> names;
  for (const EvaluatedRecording& evaluated : evaluation.recordings) {
    if (names.insert(evaluated.recording.name).second) continue;
    throw Error(
        fmt::format("{}: two recordings are named {}, their trajectories would overwrite "
                    "each other",
                    path, evaluated.recording.name));
  }
  MakeFolder(path);
  for (const EvaluatedRecording& evaluated : evaluation.recordings) {
    WriteNpz(TrajectoryOf(evaluated),
             (std::filesystem::path(path) / (evaluated.recording.name + ".npz")).string());
  }
}

}  // namespace physpring
