// SPDX-License-Identifier: Apache-2.0
#include "cli/warnings.h"

#include "cli/message.h"
#include "jobs/checkpoint.h"
#include "jobs/remarks.h"
#include "twin/checks/plausibility.h"

namespace physpring {

void PrintWarnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : JoinAlike(warnings)) Tell("warning: {}\n", warning);
}

void PrintRemarks(std::span<const Recording> recordings) {
  PrintWarnings(WarningsOf(recordings));
  for (const std::string& note : JoinAlike(NotesOf(recordings))) Tell("note: {}\n", note);
}

void WarnOfTraining(const Twin& twin, const std::string& path) {
  if (!IsFinished(twin)) {
    Tell("warning: {}: its training is not finished; `physpring train` with --resume goes on\n",
         path);
  }
  if (!twin.fit_errors) return;
  const FitErrors& fit = *twin.fit_errors;
  const std::string little = TooLittleExplained(fit.track, fit.motionless, fit.noise);
  if (!little.empty()) Tell("warning: {}: of what it was trained on, {}\n", path, little);
}

}  // namespace physpring
