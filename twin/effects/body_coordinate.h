// SPDX-License-Identifier: Apache-2.0
// A coordinate along the body, 0 at one end and 1 at the other: the arc length of a rod, otherwise
// the position along the longest principal axis of the reference configuration. And smooth fields
// on it: piecewise linear between values at evenly spaced knots. Fields do not depend on how many
// nodes a level has.
#ifndef PHYSPRING_TWIN_EFFECTS_BODY_COORDINATE_H_
#define PHYSPRING_TWIN_EFFECTS_BODY_COORDINATE_H_

#include "twin/spring_mass_system.h"

namespace physpring {

// The coordinate of each node and controller. All 0 for a body that is one point.
Eigen::VectorXd BodyCoordinate(const SpringMassSystem& system);

// For each node and controller, its place across the body, 3 x (nodes + controllers), m: seen from
// the mean, without what lies along the longest principal axis. All 0 for a rod.
Points PlaceAcross(const SpringMassSystem& system);

// Row i: the weights of `knots` values in the field at coordinate[i]. A field is Knots(..) *
// values.
Eigen::MatrixXd KnotWeights(const Eigen::VectorXd& coordinate, int knots);

// For each node, how much a thing at `place` (m, in the reference configuration) is attached to it:
// exp(-|position - place|^2 / 2 r^2), or 0 below exp(-200), scaled to a sum of 1; r is half the
// mean distance of a node to its nearest one along a spring, so that a thing on a node is on this
// one for the most part.
Eigen::VectorXd PatchWeights(const SpringMassSystem& system, const Eigen::Vector3d& place);

// Adds to place_bar, given d loss / d weights, at the weights that belong to `place`.
void PatchWeightsAdjoint(const SpringMassSystem& system, const Eigen::Vector3d& place,
                         const Eigen::VectorXd& weights, const Eigen::VectorXd& weights_bar,
                         Eigen::Ref<Eigen::Vector3d> place_bar);

// About `count` nodes spread over the reference configuration, each far from the others.
std::vector<int> SpreadNodes(const SpringMassSystem& system, int count);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_EFFECTS_BODY_COORDINATE_H_
