// SPDX-License-Identifier: Apache-2.0
// What episodes say, as a table and as JSON (docs/rollout.md).
#ifndef PHYSPRING_REPORT_ROLLOUT_REPORT_H_
#define PHYSPRING_REPORT_ROLLOUT_REPORT_H_

#include <string>
#include <vector>

#include "rollout/episode_files.h"

namespace physpring {

// The episodes of one task and one policy.
struct JudgedPolicy {
  std::string task, policy;
  std::vector<EpisodeSummary> episodes;
};

// The episodes in folders of sweeps (rollout/sweep_folder.h), those of one sweep together, each
// once. Throws Error for a folder that holds none, or damaged ones.
std::vector<JudgedPolicy> ReadPolicies(const std::vector<std::string>& folders);

// The tables have a row for each level of each policy. Below, they say how the other levels agree
// with the lowest and, with two policies or more, how the levels rank them.
std::string FormatTables(const std::vector<JudgedPolicy>& policies);
std::string FormatJson(const std::vector<JudgedPolicy>& policies);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_ROLLOUT_REPORT_H_
