// SPDX-License-Identifier: Apache-2.0
// physpring diagnose: a twin and recordings of its object -> what the twin lacks, and a twin that
// has it.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
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
#include "cli/warnings.h"
#include "diagnosis/diagnosis.h"
#include "diagnosis/diagnosis_recordings.h"
#include "jobs/diagnosis_checkpoint.h"
#include "jobs/diagnosis_input.h"
#include "jobs/training_recordings.h"
#include "report/diagnosis/page.h"
#include "report/diagnosis_json.h"
#include "report/diagnosis_text.h"
#include "trainer/data/fit_data.h"
#include "twin/atomic_file.h"
#include "twin/clock_offset.h"
#include "twin/dataset.h"
#include "twin/error.h"
#include "twin/output_lock.h"
#include "twin/stop_request.h"

namespace physpring {
namespace {

struct DiagnoseArguments {
  std::string twin, output, json;
  std::vector<std::string> recordings, held_out, before;
  bool look_for_before = true;  // in the folders of the twin and the recordings
  DiagnosisOptions options;
  ResumeOptions run;
};

struct Outputs {
  std::string report, page, twin, checkpoint;
};

// The recordings of the object before it changed: those that are given, or those that the twin was
// trained on, if they are there.
void ReadBefore(const DiagnoseArguments& arguments, const Twin& twin, DiagnosisInput* input) {
  for (const RecordingEntry& entry : ListRecordings(arguments.before, Role::kFit)) {
    input->before.push_back(ReadRecordingFor(twin, entry.path));
    input->before_paths.push_back(entry.path);
  }
  if (!input->before.empty() || !arguments.look_for_before) return;
  if (!MayBeFromBefore(twin, *input)) return;
  std::vector<std::string> files = {arguments.twin};
  for (const auto* list : {&arguments.recordings, &arguments.held_out}) {
    files.insert(files.end(), list->begin(), list->end());
  }
  input->before = FindTrainingRecordings(twin, files);
  for (const Recording& recording : input->before) input->before_paths.push_back(recording.name);
}

// All of them can be written.
Outputs CheckedOutputs(const DiagnoseArguments& arguments) {
  const std::filesystem::path folder(arguments.output);
  const Outputs outputs{(folder / "report.json").string(), (folder / "report.html").string(),
                        (folder / std::filesystem::path(arguments.twin).filename()).string(),
                        (folder / "checkpoint.npz").string()};
  std::vector<std::string> inputs{arguments.twin};
  const auto add = [&](const std::vector<std::string>& list, Role role) {
    for (const RecordingEntry& entry : ListRecordings(list, role)) inputs.push_back(entry.path);
  };
  add(arguments.recordings, Role::kFit);
  add(arguments.held_out, Role::kHeldout);
  add(arguments.before, Role::kFit);
  ExpectOutputs({outputs.report, outputs.page, outputs.twin, outputs.checkpoint, arguments.json},
                inputs);
  return outputs;
}

// Diagnoses with progress and checkpoints. A signal leaves a checkpoint and throws Interrupted.
Diagnosis DiagnoseWith(const DiagnosisCheckpoint& checkpoint, const Twin& twin,
                       const DiagnosisRecordings& recordings, const DiagnoseArguments& arguments) {
  using Clock = std::chrono::steady_clock;
  const InterruptWatch watch;
  Journal journal;
  if (arguments.run.resume) checkpoint.Resume(&journal);
  std::optional<Progress> progress;  // begins with the first piece that is not in the checkpoint
  double done = 0;
  journal.progress = [&](double share, const std::string& status) {
    StopIfRequested();
    if (!progress) progress.emplace(share);
    done = std::max(done, share);
    progress->Show(share, status);
  };
  Clock::time_point written = Clock::now();
  journal.kept = [&](const Journal::Piece&) {
    const std::chrono::duration<double> since = Clock::now() - written;
    if (since.count() < arguments.run.checkpoint_interval) return;
    checkpoint.Write(journal);
    written = Clock::now();
  };
  DiagnosisOptions options = arguments.options;
  options.journal = &journal;
  try {
    Diagnosis diagnosis = Diagnose(twin, recordings, options);
    checkpoint.Write(journal);
    return diagnosis;
  } catch (const Stopped&) {
    progress.reset();
    checkpoint.Write(journal);
    Tell("physpring: stopped at {:.0f} %; the same command with --resume goes on from {}\n",
         std::min(99.0, 100 * done), checkpoint.path());
    throw Interrupted{watch.signal()};
  }
}

void Run(const DiagnoseArguments& arguments) {
  const Twin twin = ReadTwin(arguments.twin);
  DiagnosisInput input;
  input.data = ByClockOf(twin, ReadFitData(ListRecordings(arguments.recordings, Role::kFit)));
  for (const RecordingEntry& entry : ListRecordings(arguments.held_out, Role::kHeldout)) {
    input.judged.push_back(ReadRecordingFor(twin, entry.path));
    input.judged_paths.push_back(entry.path);
  }
  ReadBefore(arguments, twin, &input);
  ExpectApart(input);
  const DiagnosisRecordings chosen = CheckAndChoose(twin, &input);
  for (const auto* recordings : {&input.data.recordings, &input.judged, &input.before}) {
    PrintRemarks(*recordings);
  }
  const OutputFolder folder(arguments.output);
  const Outputs outputs = CheckedOutputs(arguments);
  const OutputLock lock(arguments.output);
  const DiagnosisCheckpoint checkpoint(outputs.checkpoint, arguments.twin, chosen,
                                       arguments.options);
  const bool replace = arguments.run.resume || arguments.run.force;
  checkpoint.ExpectReplaceable(outputs.report, replace);
  for (const std::string& output : {outputs.page, outputs.twin}) ExpectNew(output, replace);
  const Diagnosis diagnosis = DiagnoseWith(checkpoint, twin, chosen, arguments);
  const std::string json = FormatDiagnosisJson(diagnosis);
  WriteFileAtomically(outputs.report, json);
  if (!arguments.json.empty()) WriteFileAtomically(arguments.json, json);
  const std::string name = std::filesystem::path(arguments.twin).filename().string();
  WriteFileAtomically(outputs.page, FormatDiagnosisPage(diagnosis, chosen, "Diagnosis of " + name));
  WriteTwin(diagnosis.twin, outputs.twin);
  checkpoint.Finish();
  PrintWarnings(WarningsOf(twin, chosen));
  PrintWarnings(WarningsOf(diagnosis));
  fmt::print("{}", FormatDiagnosisText(diagnosis));
}

}  // namespace

void AddDiagnoseCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("diagnose",
                         "Finds the physical effect that a twin lacks on measured "
                         "recordings, adds it, and reports the "
                         "error before and after on frames not fitted. Ctrl-C leaves a "
                         "checkpoint.");
  const auto arguments = std::make_shared<DiagnoseArguments>();
  command->add_option("twin", arguments->twin, "twin")->required()->type_name("TWIN.twin.npz");
  command
      ->add_option("recordings", arguments->recordings,
                   "recordings, or folders with a dataset.json (their `fit` ones); of many, some "
                   "are fitted")
      ->required()
      ->type_name("REC.npz|DIR");
  command
      ->add_option("-o,--output", arguments->output,
                   "folder for report.html, report.json and the twin with the effects")
      ->required()
      ->check(NotEmpty())
      ->type_name("DIR");
  command
      ->add_option("--heldout", arguments->held_out,
                   "recordings to judge by (of many, some); without them whole runs, of fewer than "
                   "four the future frames, or blocks of frames")
      ->type_name("REC.npz|DIR");
  command
      ->add_option("--before", arguments->before,
                   "recordings of the object before it changed; fitted, too, without new effects "
                   "(default: those that the twin was trained on, if they lie beside the twin or "
                   "the recordings)")
      ->type_name("REC.npz|DIR");
  command
      ->add_flag("!--no-before", arguments->look_for_before,
                 "do not look for recordings that the twin was trained on")
      ->excludes("--before");
  command->add_option("--json", arguments->json, "write report.json here, too")
      ->type_name("FILE.json");
  AddResumeOptions(command, &arguments->run,
                   "go on with an unfinished diagnosis in DIR, if there is one",
                   "overwrite a diagnosis");
  AddSeed(command, &arguments->options.seed, "of the bootstrap");
  arguments->options.threads = AllCores();
  AddThreads(command, &arguments->options.threads, "at most; the result does not depend on it");
  command->callback([arguments] { Run(*arguments); });
}

}  // namespace physpring
