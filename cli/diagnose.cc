// SPDX-License-Identifier: Apache-2.0
// physpring diagnose: a twin and recordings of its object -> what the twin lacks, and a twin that
// has it.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/diagnosis_report.h"
#include "cli/interrupt.h"
#include "cli/option_values.h"
#include "cli/output_files.h"
#include "cli/progress.h"
#include "trainer/diagnosis/diagnosis.h"
#include "trainer/fit_data.h"
#include "twin/atomic_file.h"
#include "twin/dataset.h"
#include "twin/error.h"

namespace physpring {
namespace {

struct Arguments {
  std::string twin, output, json;
  std::vector<std::string> recordings, held_out;
  DiagnosisOptions options;
};

struct Outputs {
  std::string report, page, twin;
};

// Before the work: makes the folder.
Outputs MakeOutputs(const Arguments& arguments, const std::vector<RecordingEntry>& fit,
                    const std::vector<RecordingEntry>& held_out) {
  const std::filesystem::path folder(arguments.output);
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) {
    throw Error(fmt::format("{}: cannot be made: {}", arguments.output, failure.message()));
  }
  const Outputs outputs{(folder / "report.json").string(), (folder / "report.html").string(),
                        (folder / std::filesystem::path(arguments.twin).filename()).string()};
  std::vector<std::string> inputs{arguments.twin};
  for (const RecordingEntry& entry : fit) inputs.push_back(entry.path);
  for (const RecordingEntry& entry : held_out) inputs.push_back(entry.path);
  ExpectOutputs({outputs.report, outputs.page, outputs.twin, arguments.json}, inputs);
  return outputs;
}

void Run(const Arguments& arguments) {
  const Twin twin = ReadTwin(arguments.twin);
  const auto fit = ListRecordings(arguments.recordings, Role::kFit);
  const auto held_out = ListRecordings(arguments.held_out, Role::kHeldout);
  const FitData data = ReadFitData(fit);
  std::vector<Recording> judged;
  for (const RecordingEntry& entry : held_out) judged.push_back(ReadRecording(entry.path));
  const Outputs outputs = MakeOutputs(arguments, fit, held_out);
  const InterruptWatch watch;
  DiagnosisOptions options = arguments.options;
  Diagnosis diagnosis;
  {
    Progress progress(0);
    options.progress = [&](double share, const std::string& status) {
      if (watch.signal() != 0) throw Interrupted{watch.signal()};
      progress.Show(share, status);
    };
    diagnosis = Diagnose(twin, data.recordings, judged, options);
  }
  const std::string json = FormatDiagnosisJson(diagnosis);
  WriteFileAtomically(outputs.report, json);
  if (!arguments.json.empty()) WriteFileAtomically(arguments.json, json);
  const std::string name = std::filesystem::path(arguments.twin).filename().string();
  WriteFileAtomically(outputs.page, FormatDiagnosisPage(diagnosis, "Diagnosis of " + name));
  WriteTwin(diagnosis.twin, outputs.twin);
  fmt::print("{}", FormatDiagnosisText(diagnosis));
}

}  // namespace

void AddDiagnoseCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("diagnose",
                                         "Finds the physical effect that a twin lacks on measured "
                                         "recordings, adds it, and reports the "
                                         "error before and after on frames not fitted.");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("twin", arguments->twin, "twin")->required()->type_name("TWIN.twin.npz");
  command
      ->add_option("recordings", arguments->recordings,
                   "recordings, or folders with a dataset.json (their `fit` ones)")
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
                   "recordings to judge by; without them the future frames, or blocks of frames")
      ->type_name("REC.npz|DIR");
  command->add_option("--json", arguments->json, "write report.json here, too")
      ->type_name("FILE.json");
  AddSeed(command, &arguments->options.seed, "of the bootstrap");
  arguments->options.threads = AllCores();
  AddThreads(command, &arguments->options.threads, "at most; the result does not depend on it");
  command->callback([arguments] { Run(*arguments); });
}

}  // namespace physpring
