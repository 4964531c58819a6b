// SPDX-License-Identifier: Apache-2.0
// The simulator's node data, one record a node, padded so that a node is one (float) or two
// (double) vector registers. Real is float (speed) or double (tests, parity, the default of
// training).
#ifndef PHYSPRING_TWIN_NODE_STATE_H_
#define PHYSPRING_TWIN_NODE_STATE_H_

#include <vector>

namespace physpring {

// Position x [m] and velocity v [m/s] of a node, or the derivatives of a loss with respect to them.
// The fourth entries are padding and stay 0.
template <class Real>
struct alignas(8 * sizeof(Real)) NodeState {
  Real x[4] = {0, 0, 0, 0};
  Real v[4] = {0, 0, 0, 0};
};

// A force [N], or the derivative of a loss with respect to one.
template <class Real>
struct alignas(4 * sizeof(Real)) NodeForce {
  Real f[4] = {0, 0, 0, 0};
};

template <class Real>
using NodeStates = std::vector<NodeState<Real>>;
template <class Real>
using NodeForces = std::vector<NodeForce<Real>>;

}  // namespace physpring

#endif  // PHYSPRING_TWIN_NODE_STATE_H_
