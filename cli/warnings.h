// SPDX-License-Identifier: Apache-2.0
// Warnings to the user, "warning: FILE: WHAT", joined where they are alike (jobs/remarks.h). Notes
// are the same with "note:".
#ifndef PHYSPRING_CLI_WARNINGS_H_
#define PHYSPRING_CLI_WARNINGS_H_

#include <span>
#include <string>
#include <vector>

#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

void PrintWarnings(const std::vector<std::string>& warnings);

// The recordings' warnings and notes.
void PrintRemarks(std::span<const Recording> recordings);

// Warns if the training that wrote the twin did not come to its end, or explains little of what it
// was fitted to.
void WarnOfTraining(const Twin& twin, const std::string& path);

}  // namespace physpring

#endif  // PHYSPRING_CLI_WARNINGS_H_
