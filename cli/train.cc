// SPDX-License-Identifier: Apache-2.0
// physpring train: recordings of one object -> a twin.
#include <fmt/format.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/null_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/checkpoint.h"
#include "cli/commands.h"
#include "cli/fit_report.h"
#include "cli/interrupt.h"
#include "cli/message.h"
#include "cli/option_values.h"
#include "cli/output_files.h"
#include "cli/progress.h"
#include "cli/resume_options.h"
#include "cli/train_options.h"
#include "cli/training.h"
#include "cli/warnings.h"
#include "report/info_text.h"
#include "report/material_text.h"
#include "trainer/bodies/factors.h"
#include "trainer/data/fit_data.h"
#include "trainer/reduction/registry.h"
#include "twin/dataset.h"
#include "twin/error.h"
#include "twin/output_lock.h"
#include "twin/predict.h"

namespace physpring {
namespace {

struct TrainArguments {
  std::vector<std::string> recordings;
  std::string output, log, from, effects;
  TrainOptions options;
  ResumeOptions run;
};

// The reductions that learn features: "learned".
std::string FeatureReductions() {
  std::string names;
  for (const auto& reduction : AllReductions()) {
    if (reduction->LearnsFeatures()) names += (names.empty() ? "" : " or ") + reduction->name();
  }
  return names;
}

TrainOptions OptionsOf(const TrainArguments& arguments) {
  const bool two_stage = arguments.options.method == TrainOptions::Method::kTwoStage;
  TrainOptions options = arguments.options;
  if (options.neighbours == std::vector<int>{0}) options.neighbours.clear();  // auto

  const auto expect = [](bool right, const char* flag, const std::string& what) {
    if (!right) throw CLI::ValidationError(flag, what);
  };
  const bool counts = std::count(options.neighbours.begin(), options.neighbours.end(), 0) == 0;
  expect(counts, "--neighbours", "takes counts or auto, not both");
  expect(!two_stage || options.neighbours.empty(), "--neighbours", "is chosen by two-stage itself");
  const bool full = options.method == TrainOptions::Method::kFull;
  expect(full || options.optimizer == TrainOptions::Optimizer::kAutomatic, "--optimizer",
         "is of --method full");
  expect(options.method != TrainOptions::Method::kSmooth || options.epochs == 0, "--epochs",
         "is not of --method smooth, which ends when it gains nothing more");
  expect(options.ratios.size() + 1 >= static_cast<std::size_t>(options.levels), "--ratios",
         "needs one ratio for each level but level 0");
  const bool given = options.ratios != TrainOptions().ratios;
  expect(!given || options.ratios.size() + 1 == static_cast<std::size_t>(options.levels),
         "--ratios", "are of levels 1, 2, ...: --levels must be one more than there are");
  expect(options.reduction == TrainOptions().reduction || options.levels > 1, "--reduction",
         "needs --levels 2 or more");
  const bool learned_features =
      options.network.features == TrainOptions::Network::Features::kLearned;
  expect(learned_features || GetReduction(options.reduction).LearnsFeatures(), "--features",
         "is of --reduction " + FeatureReductions());
  expect(learned_features || options.levels > 1, "--features", "needs --levels 2 or more");
  expect(!two_stage || arguments.effects.empty(), "--effects", "is not of --method two-stage");
  expect(arguments.from.empty() || arguments.effects.empty(), "--effects",
         "and --from exclude each other: level 0 comes with its effects");
  expect(two_stage || !options.self_collision, "--self-collision", "is of --method two-stage");
  return options;
}

// Each step a line of the file with the time; without a file nowhere. The first failure to write
// one goes to `failure`: it stops no training.
void OpenLog(const std::string& path, bool append, std::string* failure) {
  try {
    const auto logger = path.empty() ? spdlog::null_logger_mt("train")
                                     : spdlog::basic_logger_mt("train", path, !append);
    logger->set_pattern("%Y-%m-%d %H:%M:%S  %v");
    logger->flush_on(spdlog::level::info);
    logger->set_error_handler([failure](const std::string& what) {
      if (failure->empty()) *failure = what;
    });
    spdlog::set_default_logger(logger);
  } catch (const spdlog::spdlog_ex& error) {
    throw Error(fmt::format("{}: cannot be written: {}", path, error.what()));
  }
}

// To the user and to the log.
void Warn(const std::vector<std::string>& warnings) {
  PrintWarnings(warnings);
  for (const std::string& warning : JoinAlike(warnings)) spdlog::info("warning: {}", warning);
}

// A twin that was trained on the same recordings.
Twin ReadLevel0(const std::string& path, const FitData& data) {
  Twin twin = ReadTwin(path);
  WarnIfUnfinished(twin, path);
  ExpectSameObject(twin, data.recordings[0]);
  for (const Recording& recording : data.recordings) {
    if (!twin.TrainingOn(recording.hash)) {
      throw Error(
          fmt::format("{}: was not trained on recording {}; --from needs a twin of the same "
                      "recordings",
                      path, recording.name));
    }
  }
  return twin;
}

// Those of a twin that was diagnosed.
std::vector<EffectValues> ReadEffects(const std::string& path) {
  std::vector<EffectValues> effects = ReadTwin(path).levels[0].system.effects;
  if (effects.empty()) throw Error(fmt::format("{}: this twin has no effects", path));
  return effects;
}

// Of forces that did not set the twin's scale.
std::vector<std::string> WarnOfUnusedForces(const Twin& twin, const FitData& data) {
  std::vector<std::string> warnings;
  for (const Recording& recording : data.recordings) {
    if (twin.force_scale || recording.force.empty()) continue;
    warnings.push_back(fmt::format(
        "recording {}: array 'force' is not used: it has no number in a frame for fitting, or does "
        "not agree with how the grasps must pull the object (N, in the axes of the recording)",
        recording.name));
  }
  return warnings;
}

void PrintReport(const std::string& output, const TrainingRun& run, const std::string& fit_error,
                 double seconds) {
  for (std::size_t i = 0; i < run.twin.levels.size(); ++i) {
    const TwinLevel& level = run.twin.levels[i];
    fmt::print("{}: level {} with {} nodes, {} springs, {:.4g} sub-steps a frame\n", output, i,
               level.system.node_count(), level.system.spring_count(),
               level.substeps_per_second / run.twin.fps);
  }
  fmt::print("{}\n", fit_error);
  fmt::print("{}", DescribeScales(run.twin));
  if (run.twin.material) fmt::print("{}", DescribeMaterial(*run.twin.material));
  if (!run.status.empty()) fmt::print("{}\n", run.status);
  fmt::print("time: {}", FormatDuration(seconds));
  for (const auto& [part, part_seconds] : run.parts) {
    fmt::print(", {} {}", part, FormatDuration(part_seconds));
  }
  fmt::print("\n");
}

// Of many recordings some are enough, so that training takes minutes.
void TellOfUnused(const FitData& data, const TrainOptions& options) {
  const int count = static_cast<int>(data.recordings.size());
  if (options.method != TrainOptions::Method::kFull || count <= kMostSpringRecordings) return;
  Tell(
      "note: {} recordings: the body is chosen by fewer, and single springs are fitted to {}, "
      "evenly "
      "spread over them\n",
      count, kMostSpringRecordings);
}

// Before the work.
void ExpectWritable(const TrainArguments& arguments, const std::vector<RecordingEntry>& entries) {
  std::vector<std::string> inputs;
  if (!arguments.from.empty()) inputs.push_back(arguments.from);
  if (!arguments.effects.empty()) inputs.push_back(arguments.effects);
  for (const RecordingEntry& entry : entries) inputs.push_back(entry.path);
  ExpectOutputs({arguments.output, arguments.log}, inputs);
}

void Run(const TrainArguments& arguments) {
  const auto start = std::chrono::steady_clock::now();
  TrainOptions options = OptionsOf(arguments);
  const std::vector<RecordingEntry> entries = ListRecordings(arguments.recordings, Role::kFit);
  const FitData data = ReadFitData(entries);
  if (!arguments.effects.empty()) options.effects = ReadEffects(arguments.effects);
  std::optional<Twin> dense;
  if (!arguments.from.empty()) dense = ReadLevel0(arguments.from, data);
  const Checkpoint checkpoint(arguments.output, data, options, arguments.from);
  ExpectWritable(arguments, entries);
  const OutputLock lock(arguments.output);
  checkpoint.ExpectReplaceable(arguments.run.resume || arguments.run.force);
  std::string log_failure;
  OpenLog(arguments.log, arguments.run.resume, &log_failure);
  PrintRemarks(data.recordings);
  TellOfUnused(data, options);
  for (const std::string& warning : JoinAlike(WarningsOf(data.recordings))) {
    spdlog::info("warning: {}", warning);
  }

  const TrainingRun run = RunTraining({data, options, dense}, checkpoint, arguments.run.resume,
                                      arguments.run.checkpoint_interval);
  if (run.signal != 0) {
    Tell(
        "physpring: stopped at {:.0f} %; the same command with --resume goes on "
        "from {}\n",
        std::min(99.0, 100 * run.share), arguments.output);
    throw Interrupted{run.signal};
  }
  Warn(WarnOfUnusedForces(run.twin, data));
  Warn(WarnOfUnjoinedControllers(run.twin, data.recordings[0].name));
  const FitReport fit = JudgeFit(run.twin, ByClockOf(run.twin, data), options);
  Warn(fit.warnings);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  PrintReport(arguments.output, run, fit.line, elapsed.count());
  if (!log_failure.empty()) {
    throw Error(fmt::format("{}: has not all lines, though {} is whole: {}", arguments.log,
                            arguments.output, log_failure));
  }
}

void AddTwinInputs(CLI::App* command, TrainArguments* arguments) {
  command
      ->add_option("--from", arguments->from,
                   "take level 0 from this twin of the same recordings, instead of fitting it")
      ->type_name("TWIN.npz");
  command
      ->add_option("--effects", arguments->effects,
                   "give the twin the effects of this one, with their values (full); `physpring "
                   "diagnose` finds them")
      ->type_name("TWIN.npz");
}

}  // namespace

void AddTrainCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "train", "Learns a twin of an object from recordings of it. Ctrl-C leaves a checkpoint.");
  const auto arguments = std::make_shared<TrainArguments>();
  command
      ->add_option("recordings", arguments->recordings,
                   "recordings, or folders with a dataset.json (their `fit` ones)")
      ->required()
      ->type_name("REC.npz|DIR");
  command->add_option("-o,--output", arguments->output, "twin to write")
      ->required()
      ->check(FileNameWith(".npz"))
      ->type_name("NAME.twin.npz");
  AddTrainFlags(command, &arguments->options);
  AddTwinInputs(command, arguments.get());
  AddSeed(command, &arguments->options.seed, "of random numbers");
  arguments->options.threads = AllCores();
  AddThreads(command, &arguments->options.threads, "at most; the result does not depend on it");
  AddResumeOptions(command, &arguments->run, "go on from the output file, if there is one",
                   "overwrite a twin");
  command->add_option("--log", arguments->log, "write a line for each step")->type_name("FILE");
  command->callback([arguments] { Run(*arguments); });
}

}  // namespace physpring
