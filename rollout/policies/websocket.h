// SPDX-License-Identifier: Apache-2.0
// A policy in another program, as openpi serves them: pi0, ACT, LeRobot's.
#ifndef PHYSPRING_ROLLOUT_POLICIES_WEBSOCKET_H_
#define PHYSPRING_ROLLOUT_POLICIES_WEBSOCKET_H_

#include <memory>
#include <string>

#include "rollout/policies/policy_adapter.h"
#include "rollout/policy.h"

namespace physpring {

// `address`: ws://HOST:PORT[/PATH]. Connects when an episode begins and asks for a chunk of actions
// whenever the last one is used up. What the server's actions lack is a PolicyError. A server that
// is not there, is gone, takes too long or tells of an error of its own is a PolicyServerError.
// Throws Error for an address of another form.
std::unique_ptr<Policy> MakeWebsocketPolicy(const Task& task, const PolicyAdapter& adapter,
                                            const std::string& address,
                                            const ServerPatience& patience);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_POLICIES_WEBSOCKET_H_
