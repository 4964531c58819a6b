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
  static constexpr int kSprings = kSpringBlock * Lanes::kBlocks;  // in a vector
  static_assert(kBlocksAtOnce % Lanes::kBlocks == 0);

  // A spring takes longer than the processor looks ahead, which would keep it waiting. So the
  // springs go through each part of the work in turn, so many vectors at a time: what a part needs
  // is long there.
  static constexpr int kChunk = 16;
  // And roots and divisions, for which there is a unit of its own, are made while the forces of
  // earlier springs are added.
  static constexpr int kAhead = 3;

  static Law Parameters(SpringView<Real> springs, int vector) {
    const int i = kSprings * vector;
    Law law;
    law.k = Lanes::Load(springs.stiffness + i);
    law.L = Lanes::Load(springs.rest_length + i);
    law.c = Lanes::Load(springs.dashpot + i);
    return law;
  }

  // d = x_a - x_b, u = v_a - v_b
  static void Subtract(SpringView<Real> springs, int vector, const NodeState<Real>* state, V* d,
                       V* u) {
    Lanes::Subtract(state, springs.a + Lanes::kBlocks * vector, springs.b + kSprings * vector, d,
                    u);
  }

  // w = f_a - f_b
  static void Subtract(SpringView<Real> springs, int vector, const NodeForce<Real>* force, V* w) {
    Lanes::Subtract(force, springs.a + Lanes::kBlocks * vector, springs.b + kSprings * vector, w);
  }

  static void MeasureSprings(SpringView<Real> springs, const NodeState<Real>* state,
                             const NodeForce<Real>* force_bar, SpringMeasures<Real> measures) {
    for (int i = 0; i < springs.blocks / Lanes::kBlocks; ++i) {
      V d[3], u[3], w[3];
      Subtract(springs, i, state, d, u);
      Law law = Parameters(springs, i);
      law.Evaluate(Law::Dot(d, d), Law::Dot(d, u));
      Lanes::Store(law.length, measures.length + kSprings * i);
      Lanes::Store(law.rate, measures.rate + kSprings * i);
      if (force_bar == nullptr) continue;
      Subtract(springs, i, force_bar, w);
      Lanes::Store(law.TensionBar(Law::Dot(d, w)), measures.tension_bar + kSprings * i);
    }
  }

  static void AddSpringForces(SpringView<Real> springs, const NodeState<Real>* state,
                              NodeForce<Real>* force) {
    if (springs.direction == nullptr) {
      springs.tension != nullptr ? AddForces<true, false>(springs, state, force)
                                 : AddForces<false, false>(springs, state, force);
    } else {
      springs.tension != nullptr ? AddForces<true, true>(springs, state, force)
                                 : AddForces<false, true>(springs, state, force);
    }
  }

  // Several functions, so that springs without effects do not pay for them.
  template <bool kHasTension, bool kWantsDirections>
  static void AddForces(SpringView<Real> springs, const NodeState<Real>* state,
                        NodeForce<Real>* force) {
    V d[kChunk][3], d_d[kChunk], d_u[kChunk], scale[kChunk];
    [[maybe_unused]] const int springs_count = kSpringBlock * springs.blocks;
    const int vectors = springs.blocks / Lanes::kBlocks;
    for (int first = 0; first < vectors; first += kChunk) {
      const int count = first + kChunk < vectors ? kChunk : vectors - first;
      const auto evaluate = [&](int i) {
        Law law = Parameters(springs, first + i);
        if constexpr (kHasTension) law.T = Lanes::Load(springs.tension + kSprings * (first + i));
        law.Evaluate(d_d[i], d_u[i]);
        scale[i] = law.scale;
        if constexpr (kWantsDirections) {
          for (int j = 0; j < 3; ++j) {
            Lanes::Store(d[i][j] * law.inverse,
                         springs.direction + springs_count * j + kSprings * (first + i));
          }
        }
      };
      for (int i = 0; i < count; ++i) {
        V u[3];
        Subtract(springs, first + i, state, d[i], u);
        d_d[i] = Law::Dot(d[i], d[i]);
        d_u[i] = Law::Dot(d[i], u);
      }
      for (int i = 0; i < count && i < kAhead; ++i) evaluate(i);
      for (int i = 0; i < count; ++i) {
        if (i + kAhead < count) evaluate(i + kAhead);
        const V on_b[3] = {scale[i] * d[i][0], scale[i] * d[i][1], scale[i] * d[i][2]};
        Lanes::AddTo(force, springs.a + Lanes::kBlocks * (first + i),
                     springs.b + kSprings * (first + i), on_b);
      }
    }
  }

  static void AddSpringForcesAdjoint(SpringView<Real> springs, const NodeState<Real>* state,
                                     const NodeForce<Real>* force_bar, NodeState<Real>* state_bar,
                                     SpringGradientView<Real> gradient) {
    springs.tension != nullptr
        ? AddForcesAdjoint<true>(springs, state, force_bar, state_bar, gradient)
        : AddForcesAdjoint<false>(springs, state, force_bar, state_bar, gradient);
  }

  template <bool kHasTension>
  static void AddForcesAdjoint(SpringView<Real> springs, const NodeState<Real>* state,
                               const NodeForce<Real>* force_bar, NodeState<Real>* state_bar,
                               SpringGradientView<Real> gradient) {
    V d[kChunk][3], u[kChunk][3], w[kChunk][3], d_d[kChunk], d_u[kChunk], d_w[kChunk];
    V along[kChunk], scale[kChunk], damping[kChunk];
    const int vectors = springs.blocks / Lanes::kBlocks;
    for (int first = 0; first < vectors; first += kChunk) {
      const int count = first + kChunk < vectors ? kChunk : vectors - first;
      for (int i = 0; i < count; ++i) {
        Subtract(springs, first + i, state, d[i], u[i]);
        Subtract(springs, first + i, force_bar, w[i]);
        d_d[i] = Law::Dot(d[i], d[i]);
        d_u[i] = Law::Dot(d[i], u[i]);
        d_w[i] = Law::Dot(d[i], w[i]);
      }
      for (int i = 0; i < count; ++i) {
        Law law = Parameters(springs, first + i);
        if constexpr (kHasTension) {
          law.T = Lanes::Load(springs.tension + kSprings * (first + i));
          law.length_bar = Lanes::Load(gradient.length + kSprings * (first + i));
          law.rate_bar = Lanes::Load(gradient.rate + kSprings * (first + i));
        }
        law.Evaluate(d_d[i], d_u[i]);
        Real* k = gradient.stiffness + kSprings * (first + i);
        Real* L = gradient.rest_length + kSprings * (first + i);
        Real* c = gradient.dashpot + kSprings * (first + i);
        V k_bar = Lanes::Load(k), L_bar = Lanes::Load(L), c_bar = Lanes::Load(c);
        law.Differentiate(d_w[i], &k_bar, &L_bar, &c_bar);
        Lanes::Store(k_bar, k);
        Lanes::Store(L_bar, L);
        Lanes::Store(c_bar, c);
        along[i] = law.along;
        scale[i] = law.scale;
        damping[i] = law.damping;
      }
      for (int i = 0; i < count; ++i) {
        V x_bar[3], v_bar[3];
        for (int j = 0; j < 3; ++j) {
          x_bar[j] = along[i] * d[i][j] + scale[i] * w[i][j] + damping[i] * u[i][j];
          v_bar[j] = damping[i] * d[i][j];
        }
        Lanes::AddTo(state_bar, springs.a + Lanes::kBlocks * (first + i),
                     springs.b + kSprings * (first + i), x_bar, v_bar);
      }
    }
  }

  static void AddDashpotForces(SpringView<Real> springs, const NodeForce<Real>* velocity,
                               NodeForce<Real>* force) {
    const int count = kSpringBlock * springs.blocks;
    for (int i = 0; i < springs.blocks / Lanes::kBlocks; ++i) {
      V u[3], n[3];
      Subtract(springs, i, velocity, u);
      for (int j = 0; j < 3; ++j) n[j] = Lanes::Load(springs.direction + count * j + kSprings * i);
      const V scale = Lanes::Load(springs.dashpot + kSprings * i) * Law::Dot(n, u);
      const V on_b[3] = {scale * n[0], scale * n[1], scale * n[2]};
      Lanes::AddTo(force, springs.a + Lanes::kBlocks * i, springs.b + kSprings * i, on_b);
    }
  }

  static void AdvanceStage(const NodeView<Real>& nodes, const StageView<Real>& stage) {
    const Quad keep = Lanes::SetQuad(stage.weights.keep), take = Lanes::SetQuad(stage.weights.take);
    const Quad back = Lanes::SetQuad(stage.weights.back);
    const Quad kick = Lanes::SetQuad(stage.weights.kick) * Lanes::LoadQuad(nodes.kick.f);
    for (int i = 0; i < stage.columns; ++i) {
      const Quad sum = Lanes::LoadQuad(stage.force[i].f) + Lanes::LoadQuad(stage.dashpots[i].f);
      const Quad next = (keep * Lanes::LoadQuad(stage.effect[i].f) + take * sum) -
                        back * Lanes::LoadQuad(stage.before[i].f);
      Lanes::StoreQuad(next, stage.next[i].f);
      Lanes::StoreQuad(Lanes::SetQuad(0), stage.dashpots[i].f);
      if (i >= nodes.nodes) continue;
      Lanes::StoreQuad(next * Lanes::SetQuad(nodes.h_over_mass[i]) + kick, stage.velocity[i].f);
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
      Lanes::kName,     MeasureSprings,        AddSpringForces,  AddSpringForcesAdjoint,
      AddDashpotForces, AdvanceStage,          UpdateVelocities, UpdateVelocitiesAdjoint,
      UpdatePositions,  UpdatePositionsAdjoint};
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_KERNEL_VECTOR_H_
