// SPDX-License-Identifier: Apache-2.0
// A policy in another program, as openpi serves them: pi0, ACT, LeRobot's.
#ifndef PHYSPRING_ROLLOUT_POLICIES_WEBSOCKET_H_
#define PHYSPRING_ROLLOUT_POLICIES_WEBSOCKET_H_

#include <memory>
#include <string>

#include "rollout/policy.h"

namespace physpring {

// `address`: ws://HOST:PORT[/PATH]. Connects when an episode begins and asks for a chunk of actions
// whenever the last one is used up. Everything that goes wrong, and an answer that takes longer
// than `patience` [s], is a PolicyError. Throws Error for an address of another form.
std::unique_ptr<Policy> MakeWebsocketPolicy(const Task& task, const std::string& address,
                                            double patience);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_POLICIES_WEBSOCKET_H_
