// SPDX-License-Identifier: Apache-2.0
// A twin as a folder for MuJoCo, as people ask for it.
#ifndef PHYSPRING_JOBS_EXPORT_H_
#define PHYSPRING_JOBS_EXPORT_H_

#include <cstdint>
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

// Twins drawn from the posterior (twin/posterior.h) that are exported beside the fitted one.
struct ExportedSamples {
  int count = 0;
  std::uint64_t seed = 0;
};

// `command`: what makes the folder, for its README. With ControllerKind::kNone the controllers are
// taken off. Each sample is a folder in it, `sample_0000` and so on, that is made alike. Nothing is
// written to disk. Throws Error as ExportTwin (exporter/export.h) does, and for samples of a twin
// without posterior.
ExportedFolder MakeExport(const Twin& twin, const ExportOptions& options,
                          const std::string& command, const ExportedSamples& samples = {});

// What to know of samples of this twin: what its recordings do not tell.
std::vector<std::string> WarningsOfSamples(const Twin& twin);

}  // namespace physpring

#endif  // PHYSPRING_JOBS_EXPORT_H_
