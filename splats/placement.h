// SPDX-License-Identifier: Apache-2.0
// Splats and a twin are made from pictures and from measured points, mostly in different frames and
// scales: what brings them together, and whether they are.
#ifndef PHYSPRING_SPLATS_PLACEMENT_H_
#define PHYSPRING_SPLATS_PLACEMENT_H_

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "splats/splats.h"
#include "twin/points.h"

namespace physpring {

// x = scale * (turn * X) + shift, from the splats' frame to the twin's.
struct Placement {
  double scale = 1;
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  // unit
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();           // m
};

// The splats there: places, sizes, axes and harmonics.
Splats Place(const Splats& splats, const Placement& placement);

struct PlacementCheck {
  double spacing = 0;         // m, median distance of neighbouring nodes; 0: one node
  double median = 0;          // m, distance of splats from their nearest nodes
  double far = 0;             // part of them that is more than three spacings off
  Eigen::Vector3d low, high;  // m, box of the splats between their 5th and 95th percentiles
  Eigen::Vector3d node_low, node_high;  // m, box of the nodes
  int large = 0;                        // splats whose deviation is more than half of that box
};

PlacementCheck CheckPlacement(const Splats& splats, const Points& nodes);

// "X Y Z to X Y Z m".
std::string BoxText(const Eigen::Vector3d& low, const Eigen::Vector3d& high);

// What a user must know of it, beginning with `file`: splats in another place or scale than the
// nodes; empty if none.
std::vector<std::string> WarningsOf(const PlacementCheck& check, const std::string& file);

}  // namespace physpring

#endif  // PHYSPRING_SPLATS_PLACEMENT_H_
