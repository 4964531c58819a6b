// SPDX-License-Identifier: Apache-2.0
#include "twin/quiet_shape.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "twin/neighbours.h"
#include "twin/rotation.h"

namespace physpring {
namespace {

// Where each column of `to` would be, by so many columns around it but not by itself.
Points ByOthers(const Points& from, const Points& to, int others) {
  const NeighbourSearch search(from);
  Points moved = to;
  for (Eigen::Index i = 0; i < from.cols(); ++i) {
    std::vector<Eigen::Index> near;
    for (const Neighbour& one : search.Nearest(from.col(i), others + 1)) {
      if (one.index != i && static_cast<int>(near.size()) < others) near.push_back(one.index);
    }
    moved.col(i) = MoveRigidly(from(Eigen::all, near), to(Eigen::all, near), from.col(i));
  }
  return moved;
}

}  // namespace

Points QuietShape(const Points& from, const Points& to, double noise) {
  std::vector<Eigen::Index> known;
  for (Eigen::Index i = 0; i < from.cols(); ++i) {
    if (from.col(i).allFinite() && to.col(i).allFinite()) known.push_back(i);
  }
  const Points start = from(Eigen::all, known), measured = to(Eigen::all, known);
  Points best;
  double least = std::numeric_limits<double>::infinity();  // mean square of a coordinate, m^2
  double most_own = 0;  // of the noise: with what so many others carry from their own noise
  for (int others : {6, 8, 12, 16, 24}) {
    if (others >= start.cols()) break;
    const Points moved = ByOthers(start, measured, others);
    const double square = (moved - measured).cwiseAbs2().mean();
    if (square >= least) continue;
    least = square;
    best = moved;
    most_own = square / (1 + 2.0 / others);  // a rigid motion has 6 numbers, of 3 x others
  }
  if (best.cols() == 0 || !(noise > 0) || !(least > 0)) return to;
  const double own = std::min(noise * noise, most_own);
  Points quiet = to;
  quiet(Eigen::all, known) += own / least * (best - measured);
  return quiet;
}

}  // namespace physpring
