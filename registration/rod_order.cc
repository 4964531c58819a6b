// SPDX-License-Identifier: Apache-2.0
#include "registration/rod_order.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "twin/checks/motion_scale.h"
#include "twin/error.h"

namespace physpring {
namespace {

constexpr double kQuantile = 0.95;

// How far apart the columns are at their farthest, m; infinite if they are never seen together.
Eigen::MatrixXd FarthestApart(const std::vector<Points>& frames) {
  const Eigen::Index count = frames[0].cols();
  Eigen::MatrixXd farthest = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      std::vector<double> distances;
      for (const Points& frame : frames) {
        const double distance = (frame.col(i) - frame.col(j)).norm();
        if (std::isfinite(distance)) distances.push_back(distance);
      }
      farthest(i, j) = farthest(j, i) = std::numeric_limits<double>::infinity();
      if (distances.empty()) continue;
      farthest(i, j) = farthest(j, i) = Quantile(kQuantile, std::move(distances));
    }
  }
  return farthest;
}

// The neighbours of each column in the shortest tree (Prim, Bell System Technical Journal 36,
// 1957).
std::vector<std::vector<Eigen::Index>> ShortestTree(const Eigen::MatrixXd& distance) {
  const Eigen::Index count = distance.rows();
  std::vector<std::vector<Eigen::Index>> joined(count);
  std::vector<bool> reached(count, false);
  std::vector<Eigen::Index> nearest(count, 0);
  reached[0] = true;
  for (Eigen::Index step = 1; step < count; ++step) {
    double least = std::numeric_limits<double>::infinity();
    Eigen::Index next = 0;
    for (Eigen::Index i = 0; i < count; ++i) {
      if (reached[i] || distance(i, nearest[i]) >= least) continue;
      least = distance(i, nearest[i]);
      next = i;
    }
    joined[next].push_back(nearest[next]);
    joined[nearest[next]].push_back(next);
    reached[next] = true;
    for (Eigen::Index i = 0; i < count; ++i) {
      if (!reached[i] && distance(i, next) < distance(i, nearest[i])) nearest[i] = next;
    }
  }
  return joined;
}

}  // namespace

Eigen::VectorXd RodOrder(const std::vector<Points>& frames, const std::string& where) {
  const Eigen::MatrixXd distance = FarthestApart(frames);
  if (!distance.allFinite()) {
    throw Error(where +
                ": two of its points are never seen together, so nothing tells their order");
  }
  const auto joined = ShortestTree(distance);
  Eigen::Index at = 0;
  for (std::size_t i = joined.size(); i-- > 0;) {
    if (joined[i].size() > 2) {
      const Eigen::Vector3d place = frames[0].col(static_cast<Eigen::Index>(i));
      throw Error(fmt::format(
          "{}: is no rod: {} others are next to the one that starts at ({:.3g}, {:.3g}, "
          "{:.3g}) m",
          where, joined[i].size(), place[0], place[1], place[2]));
    }
    if (joined[i].size() == 1) at = static_cast<Eigen::Index>(i);
  }
  Eigen::VectorXd order = Eigen::VectorXd::Zero(distance.rows());
  Eigen::Index before = -1;
  for (Eigen::Index step = 1; step < distance.rows(); ++step) {
    const auto& ways = joined[static_cast<std::size_t>(at)];
    const Eigen::Index next = ways[0] != before ? ways[0] : ways[1];
    order[next] = order[at] + distance(at, next);
    before = at;
    at = next;
  }
  return order;
}

}  // namespace physpring
