// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/unexplained.h"

#include <vector>

namespace physpring {
namespace {

struct Window {
  std::size_t first = 0, last = 0;  // [first, last)
};

// The shortest run of entries that holds half of the sum of squares.
Window HalfOfSquares(const std::vector<double>& values) {
  double total = 0;
  for (double value : values) total += value * value;
  Window best{0, values.size()};
  double held = 0;
  for (std::size_t begin = 0, end = 0; end < values.size(); ++end) {
    held += values[end] * values[end];
    while (begin < end && held - values[begin] * values[begin] >= total / 2) {
      held -= values[begin] * values[begin];
      ++begin;
    }
    if (held >= total / 2 && end + 1 - begin < best.last - best.first) best = {begin, end + 1};
  }
  return best;
}

}  // namespace

Unexplained FindUnexplained(const ResidualPattern& missing, double track, double fps) {
  Unexplained unexplained;
  unexplained.track = track;
  unexplained.converged = missing.converged;
  unexplained.located = missing.converged && missing.root_mean_square > 0;
  if (!unexplained.located) return unexplained;
  missing.node_force.maxCoeff(&unexplained.particle);
  unexplained.position = missing.node.col(unexplained.particle);
  const Window window = HalfOfSquares(missing.over_time);
  unexplained.first_time = static_cast<double>(window.first) / fps;
  unexplained.last_time = static_cast<double>(window.last) / fps;
  const auto net = missing.net.middleCols(static_cast<Eigen::Index>(window.first),
                                          static_cast<Eigen::Index>(window.last - window.first));
  const Eigen::Vector3d sum = net.rowwise().sum();
  const double length = net.colwise().norm().sum();
  unexplained.direction = sum.normalized();
  unexplained.steadiness = length > 0 ? sum.norm() / length : 0;
  return unexplained;
}

}  // namespace physpring
