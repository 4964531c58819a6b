// SPDX-License-Identifier: Apache-2.0
// A policy gives several actions at once, a chunk. This says which of them is taken when.
#ifndef PHYSPRING_ROLLOUT_POLICIES_ACTION_CHUNKS_H_
#define PHYSPRING_ROLLOUT_POLICIES_ACTION_CHUNKS_H_

#include <Eigen/Core>
#include <deque>
#include <optional>

namespace physpring {

struct ChunkOptions {
  int execute = 0;  // so many actions of a chunk are taken before the next is asked for; 0: all
  // Temporal ensembling, as ACT has it: a chunk is asked for before each action, which is the mean
  // of what all chunks say of this moment, with weights exp(-ensemble i), i = 0 for the oldest.
  std::optional<double> ensemble;
};

class ActionChunks {
 public:
  explicit ActionChunks(const ChunkOptions& options) : options_(options) {}

  void Reset() { chunks_.clear(); }

  // Whether there is no action left, so that Add must come before Next.
  bool empty() const;
  void Add(Eigen::MatrixXd chunk);  // numbers x actions, at least one
  Eigen::VectorXd Next();

 private:
  struct Chunk {
    Eigen::MatrixXd actions;
    Eigen::Index next = 0;
  };

  ChunkOptions options_;
  std::deque<Chunk> chunks_;  // the oldest first; without ensembling at most one
  bool asked_ = false;        // ensembling: a chunk came for this action
};

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_POLICIES_ACTION_CHUNKS_H_
