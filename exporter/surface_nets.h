// SPDX-License-Identifier: Apache-2.0
// Naive surface nets: the zero of a function on a grid as a closed mesh. Each cell with corners of
// both signs gets one vertex, the mean of the zeros on its edges; each grid edge between corners of
// both signs becomes the quad of the vertices of the four cells around it.
#ifndef PHYSPRING_EXPORTER_SURFACE_NETS_H_
#define PHYSPRING_EXPORTER_SURFACE_NETS_H_

#include <vector>

#include "exporter/triangle_mesh.h"

namespace physpring {

// Values at the corners of cubic cells, numbered with x running fastest.
class Grid {
 public:
  // `counts`: corners along x, y and z, at least 2 each.
  Grid(const Eigen::Vector3d& origin, double cell, const Eigen::Vector3i& counts)
      : origin_(origin), cell_(cell), counts_(counts), values_(counts.prod()) {}

  int count() const { return static_cast<int>(values_.size()); }
  const Eigen::Vector3i& counts() const { return counts_; }
  double value(int corner) const { return values_[corner]; }
  double& value(int corner) { return values_[corner]; }
  // From a corner to the next one along axis 0, 1 or 2.
  int stride(int axis) const {
    return axis == 0 ? 1 : axis == 1 ? counts_[0] : counts_[0] * counts_[1];
  }
  Eigen::Vector3i Place(int corner) const {
    return {corner % counts_[0], corner / counts_[0] % counts_[1],
            corner / (counts_[0] * counts_[1])};
  }
  Eigen::Vector3d Position(int corner) const {
    return origin_ + cell_ * Place(corner).cast<double>();
  }

 private:
  Eigen::Vector3d origin_;
  double cell_;
  Eigen::Vector3i counts_;
  std::vector<double> values_;
};

// Makes values of 0 or more negative where corners of negative values shut them off from the first
// corner of the grid.
void FillCavities(Grid* grid);

// The values on the border of the grid must be positive; negative ones are inside.
TriangleMesh SurfaceNets(const Grid& grid);

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_SURFACE_NETS_H_
