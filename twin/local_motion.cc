// SPDX-License-Identifier: Apache-2.0
#include "twin/local_motion.h"

#include <vector>

#include "twin/rotation.h"

namespace physpring {

LocalMotion::LocalMotion(const Points& from, const Points& to, int nearest) : nearest_(nearest) {
  std::vector<Eigen::Index> known;
  for (Eigen::Index i = 0; i < from.cols(); ++i) {
    if (from.col(i).allFinite() && to.col(i).allFinite()) known.push_back(i);
  }
  from_ = from(Eigen::all, known);
  to_ = to(Eigen::all, known);
  if (!known.empty()) search_.emplace(from_);
}

std::optional<Eigen::Vector3d> LocalMotion::Move(const Eigen::Vector3d& place) const {
  if (!search_) return {};
  std::vector<int> near;
  for (const Neighbour& one : search_->Nearest(place, nearest_)) near.push_back(one.index);
  return Eigen::Vector3d(MoveRigidly(from_(Eigen::all, near), to_(Eigen::all, near), place));
}

}  // namespace physpring
