// SPDX-License-Identifier: Apache-2.0
// How a policy server names and arranges what it is asked with and what it answers: a file of JSON
// (docs/rollout.md has every key).
#ifndef PHYSPRING_ROLLOUT_POLICIES_POLICY_ADAPTER_H_
#define PHYSPRING_ROLLOUT_POLICIES_POLICY_ADAPTER_H_

#include <optional>
#include <string>
#include <vector>

#include "rollout/policies/action_chunks.h"
#include "rollout/policies/action_part.h"
#include "rollout/policies/state_part.h"

namespace physpring {

// A picture in a request.
struct ImageField {
  std::string camera;
  int width = 0, height = 0;   // 0: as the task draws it
  bool mirror = false;         // left and right changed
  bool colours_first = false;  // (3, height, width) instead of (height, width, 3)
};

// One key of a request, and what is under it: exactly one of these.
struct RequestField {
  std::string key;
  std::optional<ImageField> image;
  std::vector<StatePart> state;  // one array of numbers
  bool is_prompt = false;
  std::vector<RequestField> fields;  // a map of its own
};

struct PolicyAdapter {
  std::vector<RequestField> request;
  ActionLayout action;
  PolicyFrames frames;
  ChunkOptions chunks;
  int frames_per_action = 1;  // of the task

  bool NeedsImages() const;
};

// What a request is where nobody says otherwise: all cameras under `images`, the robot as `state`,
// and the `prompt`; actions are the task's.
PolicyAdapter PlainAdapter(const Task& task);

// Throws Error, one line that begins with the file, for keys that are unknown or out of range, and
// for what the task does not have.
PolicyAdapter ReadPolicyAdapter(const std::string& file, const Task& task);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_POLICIES_POLICY_ADAPTER_H_
