// SPDX-License-Identifier: Apache-2.0
#include "report/evaluation.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace physpring {
namespace {

RowErrors ErrorsOver(const FrameErrors& direct, const FrameErrors& lifted, int first, int last) {
  return {MeanOverFrames(direct.cd, first, last),
          MeanOverFrames(direct.cd_euclidean, first, last),
          MeanOverFrames(direct.track, first, last),
          MeanOverFrames(lifted.cd, first, last),
          MeanOverFrames(lifted.cd_euclidean, first, last),
          MeanOverFrames(lifted.track, first, last)};
}

void SetErrors(const EvaluatedRecording& evaluated, const FrameErrors& direct,
               const FrameErrors& lifted, Row* row) {
  const int split = evaluated.result.first_predicted;
  if (evaluated.result.trained_on) row->fit = ErrorsOver(direct, lifted, 1, split);
  row->prediction = ErrorsOver(direct, lifted, split, evaluated.recording.frame_count());
}

// The mean over recordings of their means.
MeanError Mean(const std::vector<MeanError>& means) {
  MeanError all;
  double sum = 0;
  int count = 0;
  for (const MeanError& mean : means) {
    all.frames += mean.frames;
    all.frames_without_data += mean.frames_without_data;
    sum += mean.value.value_or(0);
    count += mean.value.has_value();
  }
  if (count > 0) all.value = sum / count;
  return all;
}

RowErrors Mean(const std::vector<RowErrors>& errors) {
  const auto mean_of = [&](MeanError RowErrors::*member) {
    std::vector<MeanError> means;
    for (const RowErrors& one : errors) means.push_back(one.*member);
    return Mean(means);
  };
  return {mean_of(&RowErrors::cd),
          mean_of(&RowErrors::cd_euclidean),
          mean_of(&RowErrors::track),
          mean_of(&RowErrors::cd_lifted),
          mean_of(&RowErrors::cd_euclidean_lifted),
          mean_of(&RowErrors::track_lifted)};
}

Row Mean(const std::vector<Row>& rows) {
  Row mean = rows[0];
  std::vector<RowErrors> fit, prediction;
  double seconds_a_frame = 0, published = 0;
  int with_published = 0;
  for (const Row& row : rows) {
    mean.substeps = std::max(mean.substeps, row.substeps);
    seconds_a_frame += row.frames_per_second > 0 ? 1 / row.frames_per_second : 0;
    if (row.fit) fit.push_back(*row.fit);
    prediction.push_back(row.prediction);
    published += row.published_l1.value_or(0);
    with_published += row.published_l1.has_value();
  }
  const double count = static_cast<double>(rows.size());
  mean.frames_per_second = seconds_a_frame > 0 ? count / seconds_a_frame : 0;
  mean.fit.reset();
  if (!fit.empty()) mean.fit = Mean(fit);
  mean.prediction = Mean(prediction);
  mean.published_l1.reset();
  if (with_published > 0) mean.published_l1 = published / with_published;
  return mean;
}

}  // namespace

std::vector<Row> RowsOf(const EvaluatedRecording& evaluated) {
  std::vector<Row> rows;
  for (const LevelResult& level : evaluated.result.levels) {
    Row& row = rows.emplace_back();
    row.name = fmt::format("level {}", level.level);
    row.level = level.level;
    row.nodes = level.nodes;
    row.springs = level.springs;
    row.substeps = level.substeps;
    row.frames_per_second = level.frames_per_second;
    if (evaluated.published_l1) row.published_l1 = level.published_l1;
    SetErrors(evaluated, level.direct, level.lifted, &row);
  }
  for (const BaselineResult& baseline : evaluated.result.baselines) {
    Row& row = rows.emplace_back();
    row.name = baseline.name;
    row.description = baseline.description;
    if (evaluated.published_l1) row.published_l1 = baseline.published_l1;
    SetErrors(evaluated, baseline.errors, baseline.errors, &row);
  }
  return rows;
}

std::vector<Row> MeanRows(const Evaluation& evaluation) {
  std::vector<std::vector<Row>> same_row;
  for (const EvaluatedRecording& evaluated : evaluation.recordings) {
    const std::vector<Row> rows = RowsOf(evaluated);
    same_row.resize(rows.size());  // all are of one object: they have the same rows
    for (std::size_t i = 0; i < rows.size(); ++i) same_row[i].push_back(rows[i]);
  }
  std::vector<Row> means;
  for (const std::vector<Row>& rows : same_row) means.push_back(Mean(rows));
  return means;
}

std::vector<AnchoredRow> AnchoredRowsOf(const EvaluatedRecording& evaluated, int anchor) {
  const RecordingResult &blind = evaluated.result, &anchored = *evaluated.anchored;
  const int frames = evaluated.recording.frame_count();
  const auto after = [&](const FrameErrors& whole, const FrameErrors& part) {
    return std::pair{MeanOverFrames(whole.track, anchor + 1, frames).value,
                     MeanOverFrames(part.track, 1, frames - anchor).value};
  };
  std::vector<AnchoredRow> rows;
  for (std::size_t n = 0; n < blind.levels.size(); ++n) {
    const auto [whole, part] = after(blind.levels[n].lifted, anchored.levels[n].lifted);
    rows.push_back({fmt::format("level {}", blind.levels[n].level), whole, part});
  }
  const auto [whole, part] = after(blind.baselines[0].errors, anchored.baselines[0].errors);
  rows.push_back({blind.baselines[0].name, whole, part});
  return rows;
}

}  // namespace physpring
