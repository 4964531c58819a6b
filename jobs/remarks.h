// SPDX-License-Identifier: Apache-2.0
// What people are told about files: warnings and notes, a line "FILE: WHAT" each.
#ifndef PHYSPRING_JOBS_REMARKS_H_
#define PHYSPRING_JOBS_REMARKS_H_

#include <span>
#include <string>
#include <vector>

#include "twin/recording.h"

namespace physpring {

// What is said of several files alike is said once, "FILE and 23 more: WHAT", in the order of the
// first.
std::vector<std::string> JoinAlike(const std::vector<std::string>& remarks);

// Those of all recordings.
std::vector<std::string> WarningsOf(std::span<const Recording> recordings);
std::vector<std::string> NotesOf(std::span<const Recording> recordings);

}  // namespace physpring

#endif  // PHYSPRING_JOBS_REMARKS_H_
