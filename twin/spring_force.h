// SPDX-License-Identifier: Apache-2.0
// The lengths and forces of all springs and dashpots, and their adjoint: the scalar reference. The
// vectorised kernels (kernel_vector.h) give the same bits. The formulas are in spring_law.h.
#ifndef PHYSPRING_TWIN_SPRING_FORCE_H_
#define PHYSPRING_TWIN_SPRING_FORCE_H_

#include "twin/kernel.h"

namespace physpring {

// Length and rate of every spring and, if there is a force_bar, d loss / d tension.
template <class Real>
void MeasureSprings(SpringView<Real> springs, const NodeState<Real>* state,
                    const NodeForce<Real>* force_bar, SpringMeasures<Real> measures);

// Adds every spring's force to its two nodes. `state` and `force` hold nodes, controllers and the
// spare node. Sets springs.direction, where it is given.
template <class Real>
void AddSpringForces(SpringView<Real> springs, const NodeState<Real>* state,
                     NodeForce<Real>* force);

// Given force_bar = d loss / d force, adds to state_bar = d loss / d state and to the derivatives
// with respect to the springs' parameters.
template <class Real>
void AddSpringForcesAdjoint(SpringView<Real> springs, const NodeState<Real>* state,
                            const NodeForce<Real>* force_bar, NodeState<Real>* state_bar,
                            SpringGradientView<Real> gradient);

// Adds the force of every dashpot to its two nodes, from springs.direction.
template <class Real>
void AddDashpotForces(SpringView<Real> springs, const NodeForce<Real>* velocity,
                      NodeForce<Real>* force);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_SPRING_FORCE_H_
