// SPDX-License-Identifier: Apache-2.0
// physpring doctor: what the program runs on, and what is wrong with it.
#include <fmt/format.h>

#include "cli/commands.h"
#include "rollout/installation.h"
#include "twin/error.h"

namespace physpring {
namespace {

void PrintVersions() {
  int failures = 0;
  for (const Finding& finding : InspectInstallation()) {
    fmt::print("{:<10} {}\n", finding.subject, finding.found);
    if (finding.problem.empty()) continue;
    fmt::print("{:<10} {}: {}\n", "", finding.required ? "FAILED" : "note", finding.problem);
    failures += finding.required;
  }
  if (failures > 0) throw Error("the installation does not work");
}

}  // namespace

void AddDoctorCommand(CLI::App& app) {
  app.add_subcommand("doctor",
                     "Prints versions, the MuJoCo in use, its plugins, OpenGL and the CPU.")
      ->callback(PrintVersions);
}

}  // namespace physpring
