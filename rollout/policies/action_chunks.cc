// SPDX-License-Identifier: Apache-2.0
#include "rollout/policies/action_chunks.h"

#include <cmath>
#include <utility>

namespace physpring {

bool ActionChunks::empty() const {
  if (options_.ensemble) return !asked_;
  return chunks_.empty();
}

void ActionChunks::Add(Eigen::MatrixXd chunk) {
  if (!options_.ensemble) chunks_.clear();
  chunks_.push_back({std::move(chunk), 0});
  asked_ = true;
}

Eigen::VectorXd ActionChunks::Next() {
  asked_ = false;
  Eigen::VectorXd action = Eigen::VectorXd::Zero(chunks_.front().actions.rows());
  double weights = 0;
  for (std::size_t i = 0; i < chunks_.size(); ++i) {
    const double weight = std::exp(-options_.ensemble.value_or(0) * static_cast<double>(i));
    action += weight * chunks_[i].actions.col(chunks_[i].next++);
    weights += weight;
  }
  action /= weights;
  std::erase_if(chunks_, [this](const Chunk& chunk) {
    const bool enough =
        !options_.ensemble && options_.execute > 0 && chunk.next >= options_.execute;
    return enough || chunk.next == chunk.actions.cols();
  });
  return action;
}

}  // namespace physpring
