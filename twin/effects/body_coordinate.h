// SPDX-License-Identifier: Apache-2.0
// A coordinate along the body, 0 at one end and 1 at the other: the arc length of a rod, otherwise
// the position along the longest principal axis of the reference configuration. And smooth fields
// on it: piecewise linear between values at evenly spaced knots. Fields do not depend on how many
// nodes a level has.
#ifndef PHYSPRING_TWIN_EFFECTS_BODY_COORDINATE_H_
#define PHYSPRING_TWIN_EFFECTS_BODY_COORDINATE_H_

#include "twin/spring_mass_system.h"

namespace physpring {

// Of each node and controller. All 0 for a body that is one point.
Eigen::VectorXd BodyCoordinate(const SpringMassSystem& system);

// Row i: the weights of `knots` values in the field at coordinate[i]. A field is Knots(..) *
// values.
Eigen::MatrixXd KnotWeights(const Eigen::VectorXd& coordinate, int knots);

// Where a thing is attached, in the reference configuration: around a place, over a radius. Also
// the derivatives of a loss with respect to them.
struct Patch {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  // m
  double spread = 0;                                // m; 0: at a point
};

// Half the mean distance of a node to its nearest one along a spring, m.
double PointRadius(const SpringMassSystem& system);

// Of each node: how much the thing is attached to it: exp(-|position - place|^2 / 2 r^2), scaled to
// a sum of 1; r^2 = PointRadius^2 + spread^2, so that a thing at a node's place is on this node for
// the most part.
Eigen::VectorXd PatchWeights(const SpringMassSystem& system, const Patch& patch);

// From d loss / d weights, at the weights that belong to the patch.
Patch PatchWeightsAdjoint(const SpringMassSystem& system, const Patch& patch,
                          const Eigen::VectorXd& weights, const Eigen::VectorXd& weights_bar);

// About `count` nodes spread over the reference configuration, each far from the others.
std::vector<int> SpreadNodes(const SpringMassSystem& system, int count);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_EFFECTS_BODY_COORDINATE_H_
