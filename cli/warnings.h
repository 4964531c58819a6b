// SPDX-License-Identifier: Apache-2.0
// Warnings to the user, "warning: FILE: WHAT". What is said of several files alike
// is said once: "warning: FILE and 23 more: WHAT". Notes are the same with "note:".
#ifndef PHYSPRING_CLI_WARNINGS_H_
#define PHYSPRING_CLI_WARNINGS_H_

#include <span>
#include <string>
#include <vector>

#include "twin/recording.h"

namespace physpring {

// One line each, "FILE: WHAT" joined where only the files differ, in the order of the first.
std::vector<std::string> JoinAlike(const std::vector<std::string>& warnings);

void PrintWarnings(const std::vector<std::string>& warnings);

// Those of all recordings.
std::vector<std::string> WarningsOf(std::span<const Recording> recordings);

// The recordings' warnings and notes.
void PrintRemarks(std::span<const Recording> recordings);

// Throws Error for a recording with grasps that begin or end: these cannot be diagnosed yet.
void ExpectLastingGrasps(const Recording& recording);

}  // namespace physpring

#endif  // PHYSPRING_CLI_WARNINGS_H_
