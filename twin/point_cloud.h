// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TWIN_POINT_CLOUD_H_
#define PHYSPRING_TWIN_POINT_CLOUD_H_

#include <cstddef>

#include "twin/points.h"

namespace physpring {

// The view of a point set that nanoflann asks for. The points must outlive it.
struct PointCloud {
  const Points& points;
  std::size_t kdtree_get_point_count() const { return static_cast<std::size_t>(points.cols()); }
  double kdtree_get_pt(std::size_t index, std::size_t dimension) const {
    return points(static_cast<Eigen::Index>(dimension), static_cast<Eigen::Index>(index));
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_POINT_CLOUD_H_
