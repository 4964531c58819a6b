// SPDX-License-Identifier: Apache-2.0
// Many episodes, at one or more levels, in threads and shards. Every episode depends on the task,
// the policy, the seed and its number only, so results are the same however they are spread.
#ifndef PHYSPRING_ROLLOUT_SWEEP_H_
#define PHYSPRING_ROLLOUT_SWEEP_H_

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "rollout/episode_files.h"
#include "rollout/make_policy.h"

namespace physpring {

struct SweepOptions {
  std::vector<int> levels{0};
  int first = 0, episodes = 1;  // numbers first ... first + episodes - 1
  int shard = 1, shards = 1;    // this shard runs the episodes shard - 1, + shards, ...
  std::uint64_t seed = 0;
  Disturbance disturbance;
  PolicyChoice policy;
  bool vary_looks = false;  // each episode has looks of its own (looks.h)
  int threads = 1;
  std::string folder;  // where episodes are kept and finished ones are found; empty: nowhere
  bool states = true;  // in the folder: the states of all frames, not only the actions
};

struct SweepHooks {
  // Changes how a compiled model is drawn, nothing that moves.
  std::function<void(mjModel*)> prepare = nullptr;
  // Cameras for one episode, made in its thread, or null. `images`: the policy needs them.
  std::function<std::unique_ptr<Viewer>(const TaskModel& model, int episode, bool images)>
      make_viewer = nullptr;
  std::function<bool()> stop = nullptr;  // asked before each frame
  // An episode is finished; one call at a time.
  std::function<void(const EpisodeSummary&, int done, int all)> report = nullptr;
};

struct Sweep {
  std::vector<EpisodeSummary> episodes;  // by number, then level; all that are finished
  int skipped = 0;                       // how many were found finished in the folder
  bool complete = true;                  // not stopped
  std::vector<std::string> warnings;     // also which episodes were damaged, and so run again
};

// Throws Error for a task that cannot be simulated, a policy that cannot be made, a folder that
// holds another sweep, cannot be written or is written by another run. An episode whose files in
// the folder are damaged is run again.
Sweep RunSweep(const Task& task, const SweepOptions& options, const SweepHooks& hooks);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_SWEEP_H_
