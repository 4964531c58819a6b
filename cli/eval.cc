// SPDX-License-Identifier: Apache-2.0
// physpring eval: a twin and recordings of its object -> how far it is from them.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/message.h"
#include "cli/option_values.h"
#include "cli/output_files.h"
#include "cli/progress.h"
#include "cli/warnings.h"
#include "jobs/evaluation.h"
#include "jobs/image_evaluation.h"
#include "report/eval_report.h"
#include "report/evaluation.h"
#include "report/picture/page.h"
#include "twin/atomic_file.h"
#include "twin/clock_offset.h"
#include "twin/dataset.h"
#include "twin/error.h"
#include "twin/parallel.h"

namespace physpring {
namespace {

struct EvalArguments {
  std::string twin;
  std::vector<std::string> recordings;
  std::string json, trajectory, picture;
  EvaluationOptions options;
  ImageOptions images;
  std::map<std::string, std::string> predictions;  // file of each name
  int threads = 1;
};

CLI::Validator EndsWithHtml() {
  return CLI::Validator(
      [](std::string& path) {
        return path.ends_with(".html") ? "" : path + " does not end with .html";
      },
      "");
}

// Checks before the work that all outputs can be written. Trajectories of several recordings go to
// a folder.
void ExpectWritable(const EvalArguments& arguments, const std::vector<RecordingEntry>& entries) {
  std::vector<std::string> inputs{arguments.twin};
  for (const RecordingEntry& entry : entries) inputs.push_back(entry.path);
  std::error_code missing;
  const bool folder =
      entries.size() > 1 || std::filesystem::is_directory(arguments.trajectory, missing);
  if (!arguments.images.pictures.empty()) {
    inputs.push_back(arguments.images.splats);
    inputs.push_back((std::filesystem::path(arguments.images.pictures) / "cameras.json").string());
  }
  for (const auto& [name, file] : arguments.predictions) inputs.push_back(file);
  ExpectOutputs({arguments.json, arguments.picture, folder ? "" : arguments.trajectory}, inputs);
}

std::vector<Baseline> ReadPredictions(const EvalArguments& arguments, const Recording& recording) {
  std::vector<Baseline> predictions;
  for (const auto& [name, file] : arguments.predictions) {
    predictions.push_back(ReadPrediction(name, file, recording));
  }
  return predictions;
}

// "NAME=FILE", of a --prediction.
void AddPrediction(const std::string& word, EvalArguments* arguments) {
  const auto fail = [](const std::string& what) {
    throw CLI::ValidationError("--prediction", what);
  };
  const std::size_t equals = word.find('=');
  if (equals == std::string::npos || equals + 1 == word.size())
    fail(word + " is not NAME=FILE.npz");
  const std::string name = word.substr(0, equals);
  try {
    ExpectPredictionName(name);
  } catch (const Error& error) {
    fail(error.what());
  }
  if (!arguments->predictions.emplace(name, word.substr(equals + 1)).second) {
    fail(name + " is given twice");
  }
}

void ComparePictures(const EvalArguments& arguments, Evaluation* evaluation) {
  Progress progress(0);
  ImageOptions options = arguments.images;
  options.threads = arguments.threads;
  options.progress = [&](double part) { progress.Show(part, "pictures"); };
  EvaluatedRecording& evaluated = evaluation->recordings[0];
  evaluated.images = UnlessStopped([&] { return EvaluateImages(options, &evaluated); });
}

// Pictures, and predictions of other methods, are of one recording.
void ExpectOneRecording(const EvalArguments& arguments, std::size_t recordings) {
  const bool of_one = !arguments.images.pictures.empty() || !arguments.predictions.empty();
  if (recordings == 1 || !of_one) return;
  throw Error(
      fmt::format("--images and --prediction are of one recording; there are {}", recordings));
}

void Run(const EvalArguments& arguments) {
  Evaluation evaluation{arguments.twin,
                        ReadTwin(arguments.twin),
                        arguments.options.predict.single_precision,
                        arguments.options.anchor,
                        {}};
  const std::vector<RecordingEntry> entries = ListRecordings(arguments.recordings, Role::kHeldout);
  ExpectOneRecording(arguments, entries.size());
  ExpectWritable(arguments, entries);
  WarnOfTraining(evaluation.twin, arguments.twin);
  evaluation.recordings.resize(entries.size());
  ParallelFor(static_cast<int>(entries.size()), arguments.threads, [&](int i) {
    Recording recording = ReadRecordingFor(evaluation.twin, entries[i].path);
    EvaluationOptions options = arguments.options;
    options.others = ReadPredictions(arguments, recording);
    evaluation.recordings[i] =
        EvaluateRecording(evaluation.twin, entries[i], std::move(recording), options);
  });
  if (!arguments.images.pictures.empty()) ComparePictures(arguments, &evaluation);

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
  PrintWarnings(WarningsOf(evaluation));
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
      ->add_option("--anchor", arguments->options.anchor,
                   "also predict anew from this frame on, from the state that `track` finds there")
      ->check(WholeNumberBetween(1, std::numeric_limits<int>::max()))
      ->type_name("FRAME");
  command
      ->add_option_function<std::vector<std::string>>(
          "--prediction",
          [arguments](const std::vector<std::string>& words) {
            for (const std::string& word : words) AddPrediction(word, arguments.get());
          },
          "also judge this prediction of another method: array particles (T, N + M, 3), m; may be "
          "repeated")
      ->allow_extra_args(false)
      ->type_name("NAME=FILE.npz");
  CLI::Option* images =
      command
          ->add_option("--images", arguments->images.pictures,
                       "also compare pictures with these, which `record --pictures` wrote")
          ->type_name("DIR");
  CLI::Option* splats =
      command
          ->add_option("--splats", arguments->images.splats,
                       "the object's splats as in frame 0, which `fit-splats` makes")
          ->type_name("SPLATS.ply");
  images->needs(splats);
  splats->needs(images);
  command->add_option("--cameras", arguments->images.cameras, "of the pictures; default: all")
      ->delimiter(',')
      ->needs(images)
      ->type_name("NAME,...");
  AddPrecision(command, &arguments->options.predict.single_precision);
  AddNumberOrAuto(command, "--substeps", &arguments->options.predict.substeps,
                  "sub-steps of a frame; auto: stable ones, no longer than in training");
  AddThreads(command, &arguments->threads,
             "recordings, or pictures, at the same time; FPS are truest with 1");
  command->callback([arguments] { Run(*arguments); });
}

}  // namespace physpring
