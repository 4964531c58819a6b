// SPDX-License-Identifier: Apache-2.0
// The policy that a user asked for.
#ifndef PHYSPRING_ROLLOUT_MAKE_POLICY_H_
#define PHYSPRING_ROLLOUT_MAKE_POLICY_H_

#include <memory>
#include <string>

#include "rollout/policy.h"

namespace physpring {

struct PolicyChoice {
  std::string text = "scripted";  // or random, replay:PATH, ws://HOST:PORT
  std::string adapter;            // file for ws://; empty: the task's
  ServerPatience patience;
};

// A PATH of replay: that is a folder holds the episodes of an earlier run (episode_files.h), each
// replayed in its own number. Throws Error unless there is such a policy for the task.
std::unique_ptr<Policy> MakePolicy(const Task& task, const PolicyChoice& choice, int level,
                                   int episode);

// The adapter's file that a policy server is spoken to by, or empty for the plain way.
std::string AdapterOf(const Task& task, const PolicyChoice& choice);

// Whether `text` has one of these forms.
bool IsPolicy(const std::string& text);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_MAKE_POLICY_H_
