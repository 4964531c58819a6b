// SPDX-License-Identifier: Apache-2.0
// Level-0 particles carried along by the nodes of a coarser level:
//   x_i = sum_I w_iI [ X_I + R_I (x_i(0) - X_I(0)) ]
// over the (at most four) nearest of the node that i belongs to and the nodes joined to that one by
// a spring; w_iI ~ 1 / distance^2 in the twin's reference configuration. R_I is the rotation of I's
// spring neighbours about I since the start. Exact at the start, and for rigid motions.
#ifndef PHYSPRING_TWIN_LIFT_H_
#define PHYSPRING_TWIN_LIFT_H_

#include <array>
#include <vector>

#include "twin/points.h"
#include "twin/twin.h"

namespace physpring {

class Lift {
 public:
  // `particles_start`: positions of level 0's free nodes in frame 0 (3 x nodes, m); the nodes of
  // `level` then are at AverageOverMembers of it.
  Lift(const Twin& twin, int level, const Points& particles_start);

  // Positions of the particles (3 x free nodes of level 0, m) when the nodes of the level are at
  // `nodes` (3 x nodes, m). At level 0 bit for bit `nodes`.
  Points Apply(const Points& nodes) const;

  // R_I of each node when the nodes are at `nodes`.
  std::vector<Eigen::Matrix3d> Rotations(const Points& nodes) const;

  // d loss / d nodes (3 x nodes) from d loss / d Apply(nodes), the rotations' part included.
  Points Adjoint(const Points& nodes, const Points& particles_bar) const;

 private:
  struct Anchor {
    int node = 0;
    double weight = 0;
  };
  using Anchors = std::array<Anchor, 4>;  // unused ones have weight 0

  // Where a node's spring neighbours are about it: at the start, and when the nodes are at `nodes`.
  struct Neighbourhood {
    Points from, to;
  };
  Neighbourhood NeighbourhoodOf(int node, const Points& nodes) const;

  bool identity_;
  Points particles_start_, nodes_start_;
  std::vector<std::vector<int>> neighbours_;  // for each node, those that springs join it to
  std::vector<Anchors> anchors_;              // one for each particle
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_LIFT_H_
