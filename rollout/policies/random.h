// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_ROLLOUT_POLICIES_RANDOM_H_
#define PHYSPRING_ROLLOUT_POLICIES_RANDOM_H_

#include <memory>

#include "rollout/policy.h"

namespace physpring {

// Cartesian: every half second another goal, up to 0.15 m from where the hand was at first, and
// another gripper. Joints: every half second another goal, up to 0.3 (rad or m) from where they
// were.
std::unique_ptr<Policy> MakeRandomPolicy(const Task& task);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_POLICIES_RANDOM_H_
