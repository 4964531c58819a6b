// SPDX-License-Identifier: Apache-2.0
#include "tracker/soft_match.h"

#include <cmath>
#include <vector>

#include "twin/neighbours.h"

namespace physpring {

SoftMatch MatchSoftly(const Points& nodes, const Eigen::VectorXd& weight, const Points& cloud,
                      double width, double none) {
  constexpr int kNearest = 8;           // further nodes have no part
  constexpr double kLeastCount = 1e-9;  // of a node that something belongs to
  SoftMatch match{Eigen::VectorXd::Zero(nodes.cols()), Points::Zero(3, nodes.cols())};
  const NeighbourSearch search(nodes);
  for (const auto& point : cloud.colwise()) {
    if (!point.allFinite()) continue;
    const std::vector<Neighbour> nearest = search.Nearest(point, kNearest);
    std::vector<double> parts;
    double sum = none;
    for (const Neighbour& node : nearest) {
      parts.push_back(weight[node.index] *
                      std::exp(-0.5 * node.distance * node.distance / (width * width)));
      sum += parts.back();
    }
    if (!(sum > 0)) continue;  // it is far from all
    for (std::size_t n = 0; n < nearest.size(); ++n) {
      match.count[nearest[n].index] += parts[n] / sum;
      match.target.col(nearest[n].index) += parts[n] / sum * point;
    }
  }
  for (Eigen::Index i = 0; i < nodes.cols(); ++i) {
    const bool matched = match.count[i] > kLeastCount;
    if (!matched) match.count[i] = 0;
    match.target.col(i) = matched ? Eigen::Vector3d(match.target.col(i) / match.count[i])
                                  : Eigen::Vector3d(nodes.col(i));
  }
  return match;
}

}  // namespace physpring
