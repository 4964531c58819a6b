// SPDX-License-Identifier: Apache-2.0
// Which node does a point of a cloud belong to? Softly, as in the expectation step of coherent
// point drift: nodes are the centres of equal normal distributions, a point s belongs to node i in
// the part
//   p_i(s) = g_i exp(-|s - x_i|^2 / 2 w^2) / (sum_k g_k exp(-|s - x_k|^2 / 2 w^2) + c),
// with weights g_i (seen_nodes.h), and c stands for points that belong to none.
//   Myronenko and Song, Point Set Registration: Coherent Point Drift, IEEE TPAMI 32 (2010).
#ifndef PHYSPRING_TRACKER_SOFT_MATCH_H_
#define PHYSPRING_TRACKER_SOFT_MATCH_H_

#include "twin/points.h"

namespace physpring {

struct SoftMatch {
  Eigen::VectorXd count;  // (nodes): how many points belong to a node, sum_s p_i(s)
  Points target;          // 3 x nodes, m: their weighted mean; the node itself if there are none
};

// `nodes`: 3 x nodes, m. `weight`: (nodes), g, 0 to 1. `cloud`: 3 x points, m; columns of NaN are
// no points. `width`: w, m. `none`: c, 0 to 1; a point at that distance where g exp(...) = c
// belongs to none by half.
SoftMatch MatchSoftly(const Points& nodes, const Eigen::VectorXd& weight, const Points& cloud,
                      double width, double none);

}  // namespace physpring

#endif  // PHYSPRING_TRACKER_SOFT_MATCH_H_
