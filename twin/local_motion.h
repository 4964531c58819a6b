// SPDX-License-Identifier: Apache-2.0
// How a body moves near a point of it: as the columns nearest to that point do, as a rigid body.
#ifndef PHYSPRING_TWIN_LOCAL_MOTION_H_
#define PHYSPRING_TWIN_LOCAL_MOTION_H_

#include <optional>

#include "twin/neighbours.h"
#include "twin/points.h"

namespace physpring {

class LocalMotion {
 public:
  // The columns go from `from` to `to`, m; those that are NaN in either are left out. So many of
  // them move a point along.
  LocalMotion(const Points& from, const Points& to, int nearest = 8);

  // Where a point is in `to` that is at `place` in `from`; nothing if no column is known in both.
  std::optional<Eigen::Vector3d> Move(const Eigen::Vector3d& place) const;

 private:
  int nearest_;
  Points from_, to_;
  std::optional<NeighbourSearch> search_;
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_LOCAL_MOTION_H_
