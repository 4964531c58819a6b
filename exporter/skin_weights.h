// SPDX-License-Identifier: Apache-2.0
// How the vertices of a picture follow the nodes: x = sum_I w_I (v + X_I' - X_I), sum_I w_I = 1,
// over the nodes I nearest to v. Nodes do not turn, so the weights are those of moving least
// squares of first order,
//   w_I = phi_I p_I . M^-1 p(v),   p_I = (1, X_I - v),   M = sum_I phi_I p_I p_I^T,
// with which sum_I w_I X_I = v: rotations and other affine motions of the nodes carry the picture
// along unchanged. Where the nodes leave a direction open (all in a plane or on a line), and where
// v lies outside them, a small regularisation holds the weights near those of order zero.
#ifndef PHYSPRING_EXPORTER_SKIN_WEIGHTS_H_
#define PHYSPRING_EXPORTER_SKIN_WEIGHTS_H_

#include <vector>

#include "twin/points.h"

namespace physpring {

struct SkinWeight {
  int vertex = 0;
  double weight = 0;  // may be negative
};

// For each node the vertices that it carries. `nodes` 3 x nodes, `vertices` 3 x vertices, m.
std::vector<std::vector<SkinWeight>> BindToNodes(const Points& vertices, const Points& nodes);

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_SKIN_WEIGHTS_H_
