// SPDX-License-Identifier: Apache-2.0
#include "jobs/evaluation.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

#include "jobs/fit_report.h"
#include "tracker/anchor.h"
#include "twin/error.h"
#include "twin/evaluate.h"
#include "twin/npz_fields.h"
#include "twin/numbering.h"
#include "twin/plain_name.h"
#include "twin/quote.h"
#include "twin/regrasp.h"

namespace physpring {

namespace {

// Keys of the report, beside which a prediction has its own.
constexpr std::string_view kTakenNames[] = {
    "twin",     "precision", "levels",  "recordings",     "motionless", "rigid",
    "linear",   "file",      "frames",  "trained_on",     "anchored",   "images",
    "pictures", "splats",    "cameras", "first_predicted"};

}  // namespace

void ExpectPredictionName(const std::string& name) {
  if (!IsPlainName(name)) {
    throw Error(
        fmt::format("{} cannot name a prediction; its name must be {}", Quote(name), kPlainName));
  }
  if (std::find(std::begin(kTakenNames), std::end(kTakenNames), name) != std::end(kTakenNames)) {
    throw Error(fmt::format("{} cannot name a prediction: it means something else in the report",
                            Quote(name)));
  }
}

Baseline ReadPrediction(const std::string& name, const std::string& path,
                        const Recording& recording) {
  const Npz arrays = ReadNpz(path);
  NpzFields fields(arrays, path);
  fields.SetExtent("T", static_cast<std::size_t>(recording.frame_count()));
  fields.SetExtent("N + M", static_cast<std::size_t>(recording.particle_count()));
  return {name, name, fields.Frames("particles", "N + M")};
}

EvaluatedRecording EvaluateRecording(const Twin& twin, const RecordingEntry& entry,
                                     Recording recording, const EvaluationOptions& options) {
  EvaluatedRecording evaluated;
  evaluated.path = entry.path;
  evaluated.recording = std::move(recording);
  evaluated.published_l1 = entry.published_l1 || !evaluated.recording.rod.empty();
  ExpectSameObject(twin, evaluated.recording);
  const Twin held = HeldAsIn(&evaluated.recording, twin);
  WarnOfOddNumbering(held, entry.path, &evaluated.recording);
  evaluated.result = Evaluate(held, evaluated.recording, options.predict, options.others);
  if (options.anchor > 0) {
    evaluated.anchored =
        Evaluate(held, AnchoredAt(options.anchor, held, evaluated.recording), options.predict);
  }
  return evaluated;
}

std::vector<std::string> WarningsOf(const Evaluation& evaluation) {
  std::vector<RecordingResult> results;
  std::vector<int> first, last;
  for (const EvaluatedRecording& evaluated : evaluation.recordings) {
    results.push_back(evaluated.result);
    first.push_back(evaluated.result.first_predicted);
    last.push_back(evaluated.recording.frame_count());
  }
  const std::string little =
      LittleExplained(results, first, last, evaluation.recordings[0].recording);
  std::vector<std::string> warnings = NearerBaselines(results, first, last, "this");
  if (!little.empty()) warnings.insert(warnings.begin(), little);
  return warnings;
}

}  // namespace physpring
