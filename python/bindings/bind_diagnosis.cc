// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <optional>

#include "diagnosis/diagnosis.h"
#include "jobs/diagnosis_input.h"
#include "jobs/remarks.h"
#include "python/bindings/bindings.h"
#include "python/bindings/watched_work.h"
#include "report/diagnosis/page.h"
#include "report/diagnosis_json.h"
#include "report/diagnosis_text.h"
#include "twin/clock_offset.h"
#include "twin/error.h"
#include "twin/stop_request.h"

namespace physpring {
namespace {

namespace nb = nanobind;
using Recordings = std::vector<const GivenRecording*>;

// A diagnosis with what its page shows.
struct Finding {
  Diagnosis diagnosis;
  DiagnosisRecordings recordings;
  std::string path;  // of the twin
};

void AddByClockOf(const Twin& twin, const Recordings& given, std::vector<Recording>* recordings,
                  std::vector<std::string>* paths) {
  for (const GivenRecording* one : given) {
    recordings->push_back(one->recording);
    UseClockOf(twin, &recordings->back());
    paths->push_back(one->entry.path);
  }
}

Finding DiagnoseAll(const GivenTwin& twin, const Recordings& fit, const Recordings& held_out,
                    const Recordings& before, std::uint64_t seed, int threads,
                    const nb::object& callback) {
  if (fit.empty()) throw Error("no recording is given");
  Checked(twin);
  std::vector<RecordingEntry> entries;
  std::vector<Recording> to_fit;
  for (const GivenRecording* one : fit) {
    entries.push_back(one->entry);
    to_fit.push_back(one->recording);
  }
  DiagnosisInput input;
  input.data = ByClockOf(twin.twin, CollectFitData(entries, std::move(to_fit)));
  AddByClockOf(twin.twin, held_out, &input.judged, &input.judged_paths);
  AddByClockOf(twin.twin, before, &input.before, &input.before_paths);
  ExpectApart(input);
  Finding finding;
  finding.recordings = CheckAndChoose(twin.twin, &input);
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
