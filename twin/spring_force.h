// SPDX-License-Identifier: Apache-2.0
// The force of springs and dashpots, and its adjoint. Spring e = (a, b):
//   d = x_b - x_a,  l = |d|,  n = d / l,  u = v_b - v_a
//   F = k (l - L) + c (u . n),   force on a: F n,   force on b: -F n
// The springs stand in blocks (spring_blocks.h); this is the scalar reference. The vectorised
// kernels (spring_kernel.h) give the same bits: same operations on each spring, same order of
// additions.
#ifndef PHYSPRING_TWIN_SPRING_FORCE_H_
#define PHYSPRING_TWIN_SPRING_FORCE_H_

#include "twin/node_state.h"
#include "twin/spring_blocks.h"

namespace physpring {

// force_a += F n, force_b -= F n for every spring. `state` and `force` hold nodes and controllers.
template <class Real>
void AddSpringForces(const SpringBlocks<Real>& springs, const NodeState<Real>* state,
                     NodeForce<Real>* force);

// Given force_bar = d loss / d force, adds to state_bar = d loss / d state and to the derivatives
// with respect to the springs' parameters (in the order of the blocks).
template <class Real>
void AddSpringForcesAdjoint(const SpringBlocks<Real>& springs, const NodeState<Real>* state,
                            const NodeForce<Real>* force_bar, NodeState<Real>* state_bar,
                            SpringBlockGradient<Real>* gradient);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_SPRING_FORCE_H_
