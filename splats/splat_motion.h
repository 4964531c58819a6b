// SPDX-License-Identifier: Apache-2.0
// Splats that move with the nodes of a twin's level:
//   x = sum_k w_k (x_k + F_k (X - X_k)),   F = sum_k w_k F_k,   S' = F S F^T
// over the few nodes k nearest to a splat at the start. F_k is the deformation of node k's
// neighbourhood since then: of its nearest nodes, at D before and d now,
//   F_k = (sum_j w_j d_j D_j^T + e s R_k) (sum_j w_j D_j D_j^T + e s I)^-1,   e = 0.05
// with R_k their rotation (twin/rotation.h), s a third of the trace. So splats turn and stretch as
// the nodes do, and where the nodes say nothing (across a sheet, around a line) they only turn.
// PhysTwin turns splats and does not stretch them.
#ifndef PHYSPRING_SPLATS_SPLAT_MOTION_H_
#define PHYSPRING_SPLATS_SPLAT_MOTION_H_

#include <array>
#include <vector>

#include "splats/splats.h"
#include "twin/neighbours.h"
#include "twin/points.h"

namespace physpring {

class SplatMotion {
 public:
  // `nodes`: where they are when the splats are as stored (3 x nodes, m, at least one). The splats
  // live longer.
  SplatMotion(const Splats& splats, const Points& nodes);

  // The splats when the nodes are at `nodes`.
  PlacedSplats At(const Points& nodes, int threads) const;

 private:
  static constexpr int kAnchors = 4, kNeighbours = 10;
  struct Anchor {
    int node = 0;
    float weight = 0;
  };
  struct Neighbourhood {
    std::vector<int> nodes;
    Points from;              // 3 x nodes, m, from the node itself, times the root of their weights
    Eigen::VectorXd weights;  // the roots
    Eigen::Matrix3d inverse;  // of sum D D^T + e s I
    double rigid = 0;         // e s
  };

  void Bind(const NeighbourSearch& search);
  void Surround(const NeighbourSearch& search);
  Eigen::Matrix3d Deformation(int node, const Points& nodes, Eigen::Matrix3d* rotation) const;

  const Splats& splats_;
  PlacedSplats start_;
  Points nodes_start_;
  std::vector<std::array<Anchor, kAnchors>> anchors_;
  std::vector<Neighbourhood> neighbourhoods_;
};

}  // namespace physpring

#endif  // PHYSPRING_SPLATS_SPLAT_MOTION_H_
