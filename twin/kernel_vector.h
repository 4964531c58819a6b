// SPDX-License-Identifier: Apache-2.0
// The vectorised kernel: spring_force.cc and node_update.cc with several springs, or the
// coordinates of a node, in the lanes of a vector register. `Lanes` holds what depends on the
// instruction set: how node records become vectors of coordinates and back. It is a type of an
// anonymous namespace (spring_law.h says why).
#ifndef PHYSPRING_TWIN_KERNEL_VECTOR_H_
#define PHYSPRING_TWIN_KERNEL_VECTOR_H_

#include "twin/kernel.h"
#include "twin/spring_law.h"

namespace physpring {

template <class Lanes>
struct VectorKernel {
  using Real = typename Lanes::Real;
  using V = typename Lanes::V;        // one number for each of Lanes::kBlocks blocks of springs
  using Quad = typename Lanes::Quad;  // the coordinates of a node, and 0
  using Law = SpringLaw<Lanes>;

  static Law Evaluate(const SpringView<Real>& springs, int block, const NodeState<Real>* state) {
    const int i = kSpringBlock * block;
    Law law;
    law.k = Lanes::Load(springs.stiffness + i);
    law.L = Lanes::Load(springs.rest_length + i);
    law.c = Lanes::Load(springs.dashpot + i);
    Lanes::Subtract(state, springs.a + block, springs.b + i, law.d, law.u);
    law.Evaluate();
    return law;
  }

  static void AddSpringForces(const SpringView<Real>& springs, const NodeState<Real>* state,
                              NodeForce<Real>* force) {
    for (int block = 0; block < springs.blocks; block += Lanes::kBlocks) {
      const Law law = Evaluate(springs, block, state);
      const V on_b[3] = {law.scale * law.d[0], law.scale * law.d[1], law.scale * law.d[2]};
      Lanes::AddTo(force, springs.a + block, springs.b + kSpringBlock * block, on_b);
    }
  }

  static void AddSpringForcesAdjoint(const SpringView<Real>& springs, const NodeState<Real>* state,
                                     const NodeForce<Real>* force_bar, NodeState<Real>* state_bar,
                                     const SpringGradientView<Real>& gradient) {
    for (int block = 0; block < springs.blocks; block += Lanes::kBlocks) {
      const int i = kSpringBlock * block;
      const Law law = Evaluate(springs, block, state);
      V w[3], x_bar[3], v_bar[3];
      Lanes::Subtract(force_bar, springs.a + block, springs.b + i, w);
      V k_bar = Lanes::Load(gradient.stiffness + i);
      V L_bar = Lanes::Load(gradient.rest_length + i);
      V c_bar = Lanes::Load(gradient.dashpot + i);
      law.Differentiate(w, &k_bar, &L_bar, &c_bar, x_bar, v_bar);
      Lanes::Store(k_bar, gradient.stiffness + i);
      Lanes::Store(L_bar, gradient.rest_length + i);
      Lanes::Store(c_bar, gradient.dashpot + i);
      Lanes::AddTo(state_bar, springs.a + block, springs.b + i, x_bar, v_bar);
    }
  }

  static void UpdateVelocities(const NodeView<Real>& nodes, const NodeState<Real>* state,
                               const NodeForce<Real>* force, NodeState<Real>* next) {
    const Quad kick = Lanes::LoadQuad(nodes.kick.f), decay = Lanes::SetQuad(nodes.decay);
    for (int i = 0; i < nodes.nodes; ++i) {
      const Quad h_over_mass = Lanes::SetQuad(nodes.h_over_mass[i]);
      const Quad p =
          Lanes::LoadQuad(state[i].v) + (Lanes::LoadQuad(force[i].f) * h_over_mass + kick);
      Lanes::StoreQuad(p * decay, next[i].v);
    }
  }

  static void UpdatePositions(const NodeView<Real>& nodes, const NodeState<Real>* state,
                              NodeState<Real>* next) {
    const Quad h = Lanes::SetQuad(nodes.h);
    for (int i = 0; i < nodes.nodes; ++i) {
      Lanes::StoreQuad(Lanes::LoadQuad(state[i].x) + h * Lanes::LoadQuad(next[i].v), next[i].x);
    }
  }

  static void UpdatePositionsAdjoint(const NodeView<Real>& nodes, NodeState<Real>* state_bar) {
    const Quad h = Lanes::SetQuad(nodes.h);
    for (int i = 0; i < nodes.nodes; ++i) {
      Lanes::StoreQuad(Lanes::LoadQuad(state_bar[i].v) + h * Lanes::LoadQuad(state_bar[i].x),
                       state_bar[i].v);
    }
  }

  static void UpdateVelocitiesAdjoint(const NodeView<Real>& nodes, const NodeState<Real>* state,
                                      const NodeState<Real>* next, NodeState<Real>* state_bar,
                                      NodeForce<Real>* force_bar,
                                      const NodeGradientView<Real>& gradient) {
    const Quad kick = Lanes::LoadQuad(nodes.kick.f), decay = Lanes::SetQuad(nodes.decay);
    const Quad inverse_decay = Lanes::SetQuad(1 / nodes.decay);
    Quad drag = Lanes::LoadQuad(gradient.drag->f), gravity = Lanes::LoadQuad(gradient.gravity->f);
    for (int i = 0; i < nodes.nodes; ++i) {
      const Quad v_next = Lanes::LoadQuad(next[i].v), v_next_bar = Lanes::LoadQuad(state_bar[i].v);
      const Quad p = v_next * inverse_decay, p_bar = v_next_bar * decay;
      drag += v_next * v_next_bar;
      const Quad change = p - Lanes::LoadQuad(state[i].v) - kick;
      Lanes::StoreQuad(Lanes::LoadQuad(gradient.mass[i].f) + p_bar * change, gradient.mass[i].f);
      gravity += p_bar;
      Lanes::StoreQuad(p_bar * Lanes::SetQuad(nodes.h_over_mass[i]), force_bar[i].f);
      Lanes::StoreQuad(p_bar, state_bar[i].v);
    }
    Lanes::StoreQuad(drag, gradient.drag->f);
    Lanes::StoreQuad(gravity, gradient.gravity->f);
  }

  static constexpr Kernel<Real> kKernel = {
      Lanes::kName,          AddSpringForces,         AddSpringForcesAdjoint,
      UpdateVelocities,      UpdateVelocitiesAdjoint, UpdatePositions,
      UpdatePositionsAdjoint};
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_KERNEL_VECTOR_H_
