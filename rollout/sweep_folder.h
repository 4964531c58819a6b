// SPDX-License-Identifier: Apache-2.0
// The file sweep.json of a folder of episodes: what the sweep was, so that only episodes of one and
// the same sweep are ever put together.
#ifndef PHYSPRING_ROLLOUT_SWEEP_FOLDER_H_
#define PHYSPRING_ROLLOUT_SWEEP_FOLDER_H_

#include <map>
#include <string>
#include <vector>

#include "rollout/sweep.h"

namespace physpring {

// Fills a folder that is new, or checks that what it holds is of the same sweep: task, compiled
// models, policy, seed and noise. `hashes`: of each level's model, as it was compiled. Throws Error
// if not.
void OpenSweepFolder(const Task& task, const SweepOptions& options,
                     const std::map<int, std::string>& hashes);

// A sweep as its folders tell it.
struct StoredSweep {
  std::string task, policy;
  std::string identity;                  // equal for folders of the same sweep
  std::vector<EpisodeSummary> episodes;  // by number, then level
};

// All finished episodes of a folder. Throws Error when it is not one of a sweep, or damaged.
StoredSweep ReadSweepFolder(const std::string& folder);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_SWEEP_FOLDER_H_
