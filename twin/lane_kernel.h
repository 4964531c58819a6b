// SPDX-License-Identifier: Apache-2.0
// The work of a sub-step of several rollouts side by side, one in each lane of a vector register.
// Their systems have the same springs between the same nodes, with other parameters. So a spring is
// looked up once for all of them, and nothing needs to be moved between lanes: where a single
// rollout has a number, there is an array of `lanes` numbers here, one of each rollout.
// Each lane gets the bits that a kernel for single rollouts (kernel.h) gives it: the same
// operations, the same order of additions at each node.
//
// This header is compiled for every instruction set: it holds plain data only.
#ifndef PHYSPRING_TWIN_LANE_KERNEL_H_
#define PHYSPRING_TWIN_LANE_KERNEL_H_

#include "twin/kernel.h"

namespace physpring {

inline constexpr int kMostLanes = 16;  // of any kernel

// Numbers in a node of a state (as NodeState: x, 0, v, 0), in a force, and of a spring (k, L, c).
// Each is an array of `lanes`.
inline constexpr int kLaneState = 8, kLaneVelocity = 4, kLaneForce = 3, kLaneSpring = 3;

// The springs, in blocks of 4 that share their first node.
template <class Real>
struct LaneSprings {
  int blocks;                     // even
  const int* a;                   // (blocks) the node that the springs of a block share
  const int* b;                   // (4 blocks) the other node of each spring
  const Real* parameters;         // (4 blocks) k, L, c
  const Real* tension = nullptr;  // (4 blocks) T that effects add, N; null: none
  Real* direction = nullptr;      // 3 (4 blocks), as in SpringView, spring by spring
};

// What moves the free nodes, besides the springs.
template <class Real>
struct LaneNodes {
  int nodes;
  Real h;                   // sub-step, s
  const Real* h_over_mass;  // (nodes) s/kg
  const Real* decay;        // (1) exp(-h drag)
  const Real* kick;         // (3) h g, m/s
};

// The plane that nodes touch, and the law of what it makes of their velocities (contact_law.h).
template <class Real>
struct LaneGround {
  Real normal[3];
  Real tangents[2][3];      // of the pyramidal cone
  Real offset;              // normal . x on the plane, m
  const Real* radius;       // (nodes) distance from the plane at which a node touches it, m
  Real approach;            // a node that is slower towards the plane does not touch it, m/s
  Real sliding;             // slower than this, sliding has no direction, m/s
  const Real* restitution;  // (1)
  const Real* friction;     // (1)
  const Real* pyramidal;    // (1) the cone: 1, or 0 if elliptic
};

// One stage of dashpots: StageView of all lanes, with the same weights.
template <class Real>
struct LaneStage {
  StageWeights<Real> weights;
  int columns;
  const Real* force;
  Real* dashpots;
  const Real *before, *effect;
  Real *next, *velocity;
};

template <class Real>
struct LaneKernel {
  const char* name;
  int lanes;
  double time;  // of a sub-step of all lanes, in sub-steps of a single rollout, as measured
  // Length and rate of every spring, (4 blocks) each.
  void (*measure_springs)(const LaneSprings<Real>& springs, const Real* state, Real* length,
                          Real* rate);
  void (*add_spring_forces)(const LaneSprings<Real>& springs, const Real* state, Real* force);
  // The velocities of the nodes stand as forces do.
  void (*add_dashpot_forces)(const LaneSprings<Real>& springs, const Real* velocity, Real* force);
  void (*advance_stage)(const LaneNodes<Real>& nodes, const LaneStage<Real>& stage);
  void (*update_velocities)(const LaneNodes<Real>& nodes, const Real* state, const Real* force,
                            Real* next);
  void (*update_positions)(const LaneNodes<Real>& nodes, const Real* state, Real* next);
  // The velocities of `next` <- those after the nodes of `state` hit the ground, where they do.
  void (*hit_ground)(const LaneNodes<Real>& nodes, const LaneGround<Real>& ground,
                     const Real* state, Real* next);
  // `count` numbers of each lane, each lane's in a row of its own, to side by side and back.
  void (*interleave)(const Real* const* rows, int count, Real* side_by_side);
  void (*separate)(const Real* side_by_side, int count, Real* const* rows);
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_LANE_KERNEL_H_
