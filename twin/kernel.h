// SPDX-License-Identifier: Apache-2.0
// The work of a sub-step, as a table of functions: one table for every instruction set it is
// compiled for, chosen once from what the processor can do (kernel_choice.h). All of them give the
// same bits as the scalar reference (spring_force.h, node_update.h): the same operations on each
// spring and node, rounded as IEEE 754 asks, and the same order of additions at each node. So
// results do not depend on the machine.
//
// This header is compiled for every instruction set: it holds plain data only.
#ifndef PHYSPRING_TWIN_KERNEL_H_
#define PHYSPRING_TWIN_KERNEL_H_

#include "twin/node_state.h"

namespace physpring {

inline constexpr int kSpringBlock = 4;
inline constexpr int kBlocksAtOnce = 4;  // at most, of any kernel

// The springs, in blocks of 4 that share their first node (spring_blocks.h).
template <class Real>
struct SpringView {
  int blocks;                     // a multiple of kBlocksAtOnce
  const int* a;                   // (blocks) the node that the springs of a block share
  const int* b;                   // (4 blocks) the other node of each spring
  const Real* stiffness;          // (4 blocks) k, N/m
  const Real* rest_length;        // (4 blocks) L, m
  const Real* dashpot;            // (4 blocks) c, N s/m
  const Real* tension = nullptr;  // (4 blocks) T that effects add, N; null: none
  // 3 x (4 blocks): where add_spring_forces writes the springs' directions n to, 0 of one that is
  // too short to have one; null: nowhere.
  Real* direction = nullptr;
};

// What T depends on (twin/effects/spring_tension.h), and where the adjoint of it begins.
template <class Real>
struct SpringMeasures {
  Real* length;       // (4 blocks) l, m
  Real* rate;         // (4 blocks) of change of the length, m/s
  Real* tension_bar;  // (4 blocks) d loss / d T; not asked for without a force_bar
};

// Where the derivatives with respect to the parameters of a SpringView are added to.
template <class Real>
struct SpringGradientView {
  Real* stiffness;
  Real* rest_length;
  Real* dashpot;
  // d loss / d length and rate through T: given, if there is a T.
  const Real* length = nullptr;
  const Real* rate = nullptr;
};

// What moves the free nodes, besides the springs.
template <class Real>
struct NodeView {
  int nodes;
  const Real* h_over_mass;  // (nodes) s/kg
  Real h;                   // sub-step, s
  Real decay;               // exp(-h drag)
  NodeForce<Real> kick;     // h g, m/s
};

// Sums that the derivatives with respect to mass, drag and gravity are made of (node_update.h).
template <class Real>
struct NodeGradientView {
  NodeForce<Real>* mass;     // (nodes)
  NodeForce<Real>* drag;     // (1)
  NodeForce<Real>* gravity;  // (1)
};

// One stage of dashpots (dashpot_stages.h): E_j+1 and R_j+1 from E_j, E_j-1, F and D R_j.
template <class Real>
struct StageWeights {
  Real keep, take, back;  // of E_j, of F + D R_j, of E_j-1
  Real kick;              // q_j+1
};
template <class Real>
struct StageView {
  StageWeights<Real> weights;
  int columns;                    // nodes, controllers and the spare node
  const NodeForce<Real>* force;   // F, N
  NodeForce<Real>* dashpots;      // D R_j, N; 0 afterwards
  const NodeForce<Real>* before;  // E_j-1, N
  const NodeForce<Real>* effect;  // E_j, N
  NodeForce<Real>* next;          // E_j+1, N
  NodeForce<Real>* velocity;      // R_j+1, m/s, of the nodes
};

template <class Real>
struct Kernel {
  const char* name;
  void (*measure_springs)(SpringView<Real> springs, const NodeState<Real>* state,
                          const NodeForce<Real>* force_bar, SpringMeasures<Real> measures);
  void (*add_spring_forces)(SpringView<Real> springs, const NodeState<Real>* state,
                            NodeForce<Real>* force);
  void (*add_spring_forces_adjoint)(SpringView<Real> springs, const NodeState<Real>* state,
                                    const NodeForce<Real>* force_bar, NodeState<Real>* state_bar,
                                    SpringGradientView<Real> gradient);
  // Adds c (u . n) n, from springs.direction and the velocities of the nodes.
  void (*add_dashpot_forces)(SpringView<Real> springs, const NodeForce<Real>* velocity,
                             NodeForce<Real>* force);
  void (*advance_stage)(const NodeView<Real>& nodes, const StageView<Real>& stage);
  void (*update_velocities)(const NodeView<Real>& nodes, const NodeState<Real>* state,
                            const NodeForce<Real>* force, NodeState<Real>* next);
  void (*update_velocities_adjoint)(const NodeView<Real>& nodes, const NodeState<Real>* state,
                                    const NodeState<Real>* next, NodeState<Real>* state_bar,
                                    NodeForce<Real>* force_bar,
                                    const NodeGradientView<Real>& gradient);
  void (*update_positions)(const NodeView<Real>& nodes, const NodeState<Real>* state,
                           NodeState<Real>* next);
  void (*update_positions_adjoint)(const NodeView<Real>& nodes, NodeState<Real>* state_bar);
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_KERNEL_H_
