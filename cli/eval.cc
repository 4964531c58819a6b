// SPDX-License-Identifier: Apache-2.0
// physpring eval: a twin and recordings of its object -> how far it is from them.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "cli/checkpoint.h"
#include "cli/commands.h"
#include "cli/fit_report.h"
#include "cli/message.h"
#include "cli/option_values.h"
#include "cli/output_files.h"
#include "cli/warnings.h"
#include "report/eval_report.h"
#include "report/evaluation.h"
#include "report/picture/page.h"
#include "tracker/anchor.h"
#include "trainer/solvers/parallel.h"
#include "twin/atomic_file.h"
#include "twin/clock_offset.h"
#include "twin/dataset.h"
#include "twin/numbering.h"
#include "twin/regrasp.h"

namespace physpring {
namespace {

struct EvalArguments {
  std::string twin;
  std::vector<std::string> recordings;
  std::string json, trajectory, picture;
  PredictOptions options;
  int anchor = 0;  // 0: none
  int threads = 1;
};

CLI::Validator EndsWithHtml() {
  return CLI::Validator(
      [](std::string& path) {
        return path.ends_with(".html") ? "" : path + " does not end with .html";
      },
      "");
}

EvaluatedRecording EvaluateFile(const Twin& twin, const RecordingEntry& entry,
                                const EvalArguments& arguments) {
  EvaluatedRecording evaluated;
  evaluated.path = entry.path;
  evaluated.recording = ReadRecordingFor(twin, entry.path);
  evaluated.published_l1 = entry.published_l1 || evaluated.recording.order.size() > 0;
  ExpectSameObject(twin, evaluated.recording);
  const Twin held = HeldAsIn(&evaluated.recording, twin);
  WarnOfOddNumbering(held, entry.path, &evaluated.recording);
  evaluated.result = Evaluate(held, evaluated.recording, arguments.options);
  if (arguments.anchor > 0) {
    evaluated.anchored =
        Evaluate(held, AnchoredAt(arguments.anchor, held, evaluated.recording), arguments.options);
  }
  return evaluated;
}

// Checks before the work that all outputs can be written. Trajectories of several recordings go to
// a folder.
void ExpectWritable(const EvalArguments& arguments, const std::vector<RecordingEntry>& entries) {
  std::vector<std::string> inputs{arguments.twin};
  for (const RecordingEntry& entry : entries) inputs.push_back(entry.path);
  std::error_code missing;
  const bool folder =
      entries.size() > 1 || std::filesystem::is_directory(arguments.trajectory, missing);
  ExpectOutputs({arguments.json, arguments.picture, folder ? "" : arguments.trajectory}, inputs);
}

// A twin that predicts worse than what needs no twin is of no use.
void WarnIfUseless(const Evaluation& evaluation) {
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
  PrintWarnings(warnings);
}

void Run(const EvalArguments& arguments) {
  Evaluation evaluation{arguments.twin,
                        ReadTwin(arguments.twin),
                        arguments.options.single_precision,
                        arguments.anchor,
                        {}};
  const std::vector<RecordingEntry> entries = ListRecordings(arguments.recordings, Role::kHeldout);
  ExpectWritable(arguments, entries);
  WarnIfUnfinished(evaluation.twin, arguments.twin);
  evaluation.recordings.resize(entries.size());
  ParallelFor(static_cast<int>(entries.size()), arguments.threads, [&](int i) {
    evaluation.recordings[i] = EvaluateFile(evaluation.twin, entries[i], arguments);
  });

  std::vector<Recording> recordings;
  for (const EvaluatedRecording& evaluated : evaluation.recordings) {
    recordings.push_back(evaluated.recording);
  }
  PrintRemarks(recordings);
  if (!arguments.trajectory.empty()) WriteTrajectories(evaluation, arguments.trajectory);
  if (!arguments.json.empty()) WriteFileAtomically(arguments.json, FormatJson(evaluation));
  if (!arguments.picture.empty()) {
    WriteFileAtomically(arguments.picture, FormatPage(evaluation));
  }
  fmt::print("{}", FormatTables(evaluation));
  WarnIfUseless(evaluation);
}

}  // namespace

void AddEvalCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "eval",
      "Predicts recordings of a twin's object with every level of the twin, and prints how far the "
      "predictions are from what was measured.");
  const auto arguments = std::make_shared<EvalArguments>();
  command->add_option("twin", arguments->twin, "twin")->required()->type_name("TWIN.twin.npz");
  command
      ->add_option("recordings", arguments->recordings,
                   "recordings, or folders with a dataset.json (their held-out ones)")
      ->required()
      ->type_name("REC.npz|DIR");
  command->add_option("--json", arguments->json, "write all figures, in metres")
      ->type_name("FILE.json");
  command
      ->add_option(
          "--trajectory", arguments->trajectory,
          "write the measured points as predicted: a file, or a folder for one a recording")
      ->type_name("FILE.npz|DIR");
  command->add_option("--picture", arguments->picture, "write a page with pictures and a film")
      ->check(EndsWithHtml())
      ->type_name("FILE.html");
  command
      ->add_option("--anchor", arguments->anchor,
                   "also predict anew from this frame on, from the state that `track` finds there")
      ->check(WholeNumberBetween(1, std::numeric_limits<int>::max()))
      ->type_name("FRAME");
  AddPrecision(command, &arguments->options.single_precision);
  AddNumberOrAuto(command, "--substeps", &arguments->options.substeps,
                  "sub-steps of a frame; auto: stable ones, no longer than in training");
  AddThreads(command, &arguments->threads, "recordings at the same time; FPS are truest with 1");
  command->callback([arguments] { Run(*arguments); });
}

}  // namespace physpring
