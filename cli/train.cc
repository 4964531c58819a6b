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

#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/message.h"
#include "cli/option_values.h"
#include "cli/output_files.h"
#include "cli/progress.h"
#include "cli/resume_options.h"
#include "cli/train_flags.h"
#include "cli/training_hint.h"
#include "cli/warnings.h"
#include "jobs/remarks.h"
#include "jobs/train_options_json.h"
#include "jobs/training.h"
#include "report/info_text.h"
#include "report/material_text.h"
#include "trainer/bodies/factors.h"
#include "trainer/data/fit_data.h"
#include "twin/dataset.h"
#include "twin/error.h"
#include "twin/output_lock.h"

namespace physpring {
namespace {

struct TrainArguments {
  std::vector<std::string> recordings;
  std::string output, log, from, effects;
  TrainOptions options;
  ResumeOptions run;
};

TrainOptions OptionsOf(const TrainArguments& arguments) {
  TrainOptions options = arguments.options;
  if (options.neighbours == std::vector<int>{0}) options.neighbours.clear();  // auto
  const bool counts = std::count(options.neighbours.begin(), options.neighbours.end(), 0) == 0;
  if (!counts) throw CLI::ValidationError("--neighbours", "takes counts or auto, not both");
  const TrainSources sources{!arguments.from.empty(), !arguments.effects.empty()};
  const auto error = CheckTrainOptions(options, sources);
  if (error) throw CLI::ValidationError("--" + error->option, error->why);
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
  WarnOfTraining(twin, path);
  ExpectLevel0Of(data, twin, path);
  return twin;
}

void PrintReport(const std::string& output, const TrainingRun& run, double seconds) {
  for (std::size_t i = 0; i < run.twin.levels.size(); ++i) {
    const TwinLevel& level = run.twin.levels[i];
    fmt::print("{}: level {} with {} nodes, {} springs, {:.4g} sub-steps a frame\n", output, i,
               level.system.node_count(), level.system.spring_count(),
               level.substeps_per_second / run.twin.fps);
  }
  fmt::print("{}\n", run.fit.line);
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

// A run with progress and, where it takes long, a hint. A signal leaves a checkpoint and throws
// Interrupted.
TrainingRun TrainWith(const Checkpoint& checkpoint, const TrainingTask& task,
                      const TrainArguments& arguments) {
  const InterruptWatch watch;
  std::optional<Progress> progress;  // from the first step on that is not in the checkpoint
  bool hinted = false;
  const auto show = [&](double share, const std::string& status) {
    if (!progress) progress.emplace(share);
    progress->Show(share, status);
    if (hinted) return;
    const std::string hint =
        HintIfLong(task.options, progress->seconds(), progress->SecondsLeft(share));
    hinted = !hint.empty();
    if (hinted) progress->Say(hint);
  };
  TrainingRun run =
      RunTraining(task, checkpoint, arguments.run.resume, arguments.run.checkpoint_interval, show);
  progress.reset();
  if (!run.stopped) return run;
  Tell("physpring: stopped at {:.0f} %; the same command with --resume goes on from {}\n",
       std::min(99.0, 100 * run.share), arguments.output);
  throw Interrupted{watch.signal()};
}

void Run(const TrainArguments& arguments) {
  const auto start = std::chrono::steady_clock::now();
  TrainOptions options = OptionsOf(arguments);
  const std::vector<RecordingEntry> entries = ListRecordings(arguments.recordings, Role::kFit);
  const FitData data = ReadFitData(entries);
  if (!arguments.effects.empty()) {
    options.effects = EffectsOf(ReadTwin(arguments.effects), arguments.effects);
  }
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

  const TrainingTask task{data, options, dense};
  const TrainingRun run = TrainWith(checkpoint, task, arguments);
  Warn(run.fit.warnings);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  PrintReport(arguments.output, run, elapsed.count());
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
