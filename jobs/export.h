// SPDX-License-Identifier: Apache-2.0
// A twin as a folder for MuJoCo, as people ask for it.
#ifndef PHYSPRING_JOBS_EXPORT_H_
#define PHYSPRING_JOBS_EXPORT_H_

#include <map>
#include <string>
#include <vector>

#include "exporter/options.h"
#include "twin/twin.h"

namespace physpring {

struct ExportedFolder {
  std::map<std::string, std::string> files;  // name in the folder -> content
  std::vector<std::string> warnings;         // guesses, one line each
  std::string text;                          // what each level became, lines to read
};

// `command`: what makes the folder, for its README. With ControllerKind::kNone the controllers are
// taken off. Nothing is written to disk. Throws Error as ExportTwin (exporter/export.h) does.
ExportedFolder MakeExport(const Twin& twin, const ExportOptions& options,
                          const std::string& command);

}  // namespace physpring

#endif  // PHYSPRING_JOBS_EXPORT_H_
