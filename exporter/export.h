// SPDX-License-Identifier: Apache-2.0
// A twin as a folder for MuJoCo, as in MuJoCo Menagerie: README.md, a model levelN.xml of each
// level, and scenes to try them in.
#ifndef PHYSPRING_EXPORTER_EXPORT_H_
#define PHYSPRING_EXPORTER_EXPORT_H_

#include <map>
#include <string>
#include <vector>

#include "exporter/flexes.h"
#include "exporter/level_plan.h"
#include "exporter/options.h"
#include "twin/twin.h"

namespace physpring {

struct ExportedLevel {
  LevelPlan plan;
  FlexGroups flexes;         // empty unless SpringKind::kFlex
  std::string model, scene;  // file names
};

struct Export {
  std::vector<ExportedLevel> levels;
  std::map<std::string, std::string> files;  // name in the folder -> content
  std::vector<std::string> warnings;         // guesses, one line each
};

// Nothing is written to disk. `command`: what made the folder, for its README. The twin must live
// as long as the result. Throws Error as PlanLevel does.
Export ExportTwin(const Twin& twin, const ExportOptions& options, const std::string& command);

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_EXPORT_H_
