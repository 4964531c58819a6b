// SPDX-License-Identifier: Apache-2.0
// The step of the free nodes in time, and its adjoint: the scalar reference. The vectorised kernels
// (kernel_vector.h) give the same bits.
//   velocities   v' = p exp(-h drag),   p = v + (F h / m + h g)
//   positions    x' = x + h v'
// Contacts change v' in between.
#ifndef PHYSPRING_TWIN_NODE_UPDATE_H_
#define PHYSPRING_TWIN_NODE_UPDATE_H_

#include "twin/kernel.h"

namespace physpring {

// Sets the velocities of `next`.
template <class Real>
void UpdateVelocities(const NodeView<Real>& nodes, const NodeState<Real>* state,
                      const NodeForce<Real>* force, NodeState<Real>* next);

// Sets the positions of `next` from its velocities.
template <class Real>
void UpdatePositions(const NodeView<Real>& nodes, const NodeState<Real>* state,
                     NodeState<Real>* next);

// One stage of dashpots (dashpot_stages.h).
template <class Real>
void AdvanceStage(const NodeView<Real>& nodes, const StageView<Real>& stage);

// The adjoints. state_bar: in d loss / d next, out d loss / d state at given forces.
template <class Real>
void UpdatePositionsAdjoint(const NodeView<Real>& nodes, NodeState<Real>* state_bar);

// Sets force_bar = d loss / d F, and adds to the sums over sub-steps (and, for drag and gravity,
// over nodes) that the other derivatives are made of, each coordinate for itself:
//   mass      p_bar (p - v - h g):   d loss / d m = -sum / m
//   drag      v' v'_bar:             d loss / d drag = -h sum
//   gravity   p_bar:                 d loss / d g = h sum
template <class Real>
void UpdateVelocitiesAdjoint(const NodeView<Real>& nodes, const NodeState<Real>* state,
                             const NodeState<Real>* next, NodeState<Real>* state_bar,
                             NodeForce<Real>* force_bar, const NodeGradientView<Real>& gradient);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_NODE_UPDATE_H_
