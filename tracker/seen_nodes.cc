// SPDX-License-Identifier: Apache-2.0
#include "tracker/seen_nodes.h"

#include <cmath>

namespace physpring {
namespace {

constexpr double kFading = 0.5;  // s, of counts
constexpr double kLeastWeight = 0.1;

}  // namespace

SeenNodes::SeenNodes(int nodes, int surface)
    : weight_(Eigen::VectorXd::Constant(nodes, kLeastWeight)) {
  weight_.head(surface).setOnes();
}

void SeenNodes::Learn(const Eigen::VectorXd& count, double time) {
  if (!(count.sum() > 0)) return;
  if (mean_.size() == 0) mean_ = count.sum() / weight_.sum() * weight_;
  const double fade = std::exp(-time / kFading);
  mean_ = fade * mean_ + (1 - fade) * count;
  const double of_seen = mean_.squaredNorm() / mean_.sum();  // mean of what a point finds
  weight_ = (mean_ / of_seen).cwiseMin(1).cwiseMax(kLeastWeight);
}

}  // namespace physpring
