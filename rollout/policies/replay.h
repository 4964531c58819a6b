// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_ROLLOUT_POLICIES_REPLAY_H_
#define PHYSPRING_ROLLOUT_POLICIES_REPLAY_H_

#include <memory>
#include <string>

#include "rollout/policy.h"

namespace physpring {

// Recorded actions, one after the other: the array `actions` (frames, numbers) of a NumPy archive,
// as `physpring rollout` writes for each episode. Past the last one, the last one again. Throws
// Error, beginning with the file, unless it holds such an array.
std::unique_ptr<Policy> MakeReplayPolicy(const Task& task, const std::string& file);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_POLICIES_REPLAY_H_
