// SPDX-License-Identifier: Apache-2.0
// Delaunay triangulation of points in the plane, by Bowyer and Watson: point after point, the
// triangles whose circumcircle holds it are replaced by those of the point and their outline.
// Time grows with the square of the number of points.
#ifndef PHYSPRING_EXPORTER_DELAUNAY_H_
#define PHYSPRING_EXPORTER_DELAUNAY_H_

#include <Eigen/Core>
#include <array>
#include <vector>

namespace physpring {

// Triangles (columns of `points`, 2 x points), counter-clockwise. Empty for less than 3 points or
// points on a line. A point that coincides with another one is left out.
std::vector<std::array<int, 3>> Delaunay(const Eigen::Matrix2Xd& points);

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_DELAUNAY_H_
