// SPDX-License-Identifier: Apache-2.0
// The messages of openpi's policy servers: msgpack, with NumPy arrays as maps
//   {b"__ndarray__": true, b"data": bytes, b"dtype": "<f4", b"shape": [50, 8]},
// whose keys are bytes (openpi-client, msgpack_numpy.py).
#ifndef PHYSPRING_ROLLOUT_POLICIES_OPENPI_MESSAGES_H_
#define PHYSPRING_ROLLOUT_POLICIES_OPENPI_MESSAGES_H_

#include <string>
#include <string_view>

#include "rollout/policies/policy_adapter.h"

namespace physpring {

// A request with the fields of the adapter: pictures as uint8, states as float64, the prompt as
// text.
std::string EncodeObservation(const PolicyAdapter& adapter, const Observation& observation,
                              const std::string& prompt);

// The chunk of actions of an answer, {"actions": (frames, numbers) of a float type, ...}, as
// numbers x frames. Throws PolicyServerError unless it is that, and PolicyError where the actions
// are not of `numbers` numbers.
Eigen::MatrixXd DecodeActions(std::string_view message, int numbers);

// Throws PolicyServerError unless the message is a map: what a server sends when one connects.
void CheckMetadata(std::string_view message);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_POLICIES_OPENPI_MESSAGES_H_
