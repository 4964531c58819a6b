// SPDX-License-Identifier: Apache-2.0
// Scripted policies by name, one file each: the explicit list is in registry.cc.
#ifndef PHYSPRING_ROLLOUT_POLICIES_REGISTRY_H_
#define PHYSPRING_ROLLOUT_POLICIES_REGISTRY_H_

#include <memory>

#include "rollout/policy.h"
#include "rollout/task.h"

namespace physpring {

// The policy `task.policy`. Throws Error if there is none of that name.
std::unique_ptr<Policy> MakeScriptedPolicy(const Task& task);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_POLICIES_REGISTRY_H_
