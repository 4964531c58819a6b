// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "diagnosis/diagnosis.h"
#include "jobs/diagnosis_input.h"
#include "python/bindings/given_recordings.h"
#include "python/bindings/watched_work.h"
#include "report/diagnosis/page.h"
#include "report/diagnosis_json.h"
#include "report/diagnosis_text.h"
#include "twin/stop_request.h"

namespace physpring {
namespace {

namespace nb = nanobind;

// A diagnosis with what its page shows.
struct Finding {
  Diagnosis diagnosis;
  DiagnosisRecordings recordings;
  std::string path;  // of the twin
};

void AddByClockOf(const Twin& twin, const GivenRecordings& given,
                  std::vector<Recording>* recordings, std::vector<std::string>* paths) {
  for (const GivenRecording* one : given) {
    recordings->push_back(RecordingFor(twin, *one));
    paths->push_back(one->entry.path);
  }
}

void AddAllNewWarnings(const GivenRecordings& given, const std::vector<Recording>& recordings,
                       std::vector<std::string>* warnings) {
  for (std::size_t i = 0; i < given.size(); ++i) {
    AddNewWarnings(*given[i], recordings[i], warnings);
  }
}

Finding DiagnoseAll(const GivenTwin& twin, const GivenRecordings& fit,
                    const GivenRecordings& held_out, const GivenRecordings& before,
                    std::uint64_t seed, int threads, const nb::object& callback) {
  DiagnosisInput input;
  input.data = ByClockOf(Checked(twin), FitDataOf(fit));
  AddByClockOf(twin.twin, held_out, &input.judged, &input.judged_paths);
  AddByClockOf(twin.twin, before, &input.before, &input.before_paths);
  ExpectApart(input);
  Finding finding;
  finding.recordings = CheckAndChoose(twin.twin, &input);
  std::vector<std::string> warnings;
  AddAllNewWarnings(fit, input.data.recordings, &warnings);
  AddAllNewWarnings(held_out, input.judged, &warnings);
  AddAllNewWarnings(before, input.before, &warnings);
  Warn(warnings);
  finding.path = twin.path;
  RunWatched(callback, [&](const TellShare& tell) {
    Journal journal;
    journal.progress = [&](double share, const std::string& status) {
      StopIfRequested();
      tell(share, status);
    };
    DiagnosisOptions options;
    options.threads = threads;
    options.seed = seed;
    options.journal = &journal;
    finding.diagnosis = Diagnose(twin.twin, finding.recordings, options);
  });
  Warn(WarningsOf(twin.twin, finding.recordings));
  Warn(WarningsOf(finding.diagnosis));
  return finding;
}

}  // namespace

void BindDiagnosis(nb::module_& module) {
  nb::class_<Finding> finding(module, "Finding");
  finding.def("json", [](const Finding& self) { return FormatDiagnosisJson(self.diagnosis); });
  finding.def("text", [](const Finding& self) { return FormatDiagnosisText(self.diagnosis); });
  finding.def(
      "html",
      [](const Finding& self, const std::string& title) {
        return FormatDiagnosisPage(self.diagnosis, self.recordings, title);
      },
      nb::arg("title"));
  finding.def_prop_ro("twin", [](const Finding& self) {
    return GivenTwin{self.path, self.diagnosis.twin};
  });
  module.def("diagnose", &DiagnoseAll, nb::arg("twin"), nb::arg("recordings"), nb::arg("heldout"),
             nb::arg("before"), nb::arg("seed"), nb::arg("threads"), nb::arg("callback").none());
}

}  // namespace physpring
