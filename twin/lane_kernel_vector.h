// SPDX-License-Identifier: Apache-2.0
// The kernel for rollouts side by side (lane_kernel.h): the formulas of spring_force.cc,
// node_update.cc and contact.cc, on a vector of lanes. `Lanes` holds what depends on the
// instruction set. It is a type of an anonymous namespace (spring_law.h says why).
#ifndef PHYSPRING_TWIN_LANE_KERNEL_VECTOR_H_
#define PHYSPRING_TWIN_LANE_KERNEL_VECTOR_H_

#include "twin/lane_kernel.h"
#include "twin/spring_law.h"

namespace physpring {

template <class Lanes>
struct LaneVectorKernel {
  using Real = typename Lanes::Real;
  using V = typename Lanes::V;  // a number of each lane
  using Law = SpringLaw<Lanes>;
  static constexpr int kLanes = Lanes::kLanes;

  static V Load(const Real* numbers, int i) { return Lanes::Load(numbers + kLanes * i); }
  static void Store(V x, Real* numbers, int i) { Lanes::Store(x, numbers + kLanes * i); }

  // The four springs of a block: d = x_a - x_b, d . u with u = v_a - v_b, and l. Roots and
  // divisions take long, and there is a unit of its own for them.
  struct Block {
    V d[kSpringBlock][3], d_u[kSpringBlock], length[kSpringBlock], inverse[kSpringBlock];

    void Measure(const LaneSprings<Real>& springs, int block, const Real* state) {
      const Real* a = state + kLanes * kLaneState * springs.a[block];
      for (int s = 0; s < kSpringBlock; ++s) {
        const Real* b = state + kLanes * kLaneState * springs.b[kSpringBlock * block + s];
        V u[3];
        for (int j = 0; j < 3; ++j) {
          d[s][j] = Load(a, j) - Load(b, j);
          u[j] = Load(a, kLaneVelocity + j) - Load(b, kLaneVelocity + j);
        }
        length[s] = Lanes::Sqrt(Law::Dot(d[s], d[s]));
        inverse[s] = Lanes::Inverse(length[s]);
        d_u[s] = Law::Dot(d[s], u);
      }
    }

    Law Evaluate(const LaneSprings<Real>& springs, int block, int s, V tension) const {
      const int i = kSpringBlock * block + s;
      Law law;
      law.k = Load(springs.parameters, kLaneSpring * i);
      law.L = Load(springs.parameters, kLaneSpring * i + 1);
      law.c = Load(springs.parameters, kLaneSpring * i + 2);
      law.T = tension;
      law.Evaluate(length[s], inverse[s], d_u[s]);
      return law;
    }
  };

  static void MeasureSprings(const LaneSprings<Real>& springs, const Real* state, Real* length,
                             Real* rate) {
    for (int i = 0; i < springs.blocks; ++i) {
      Block block;
      block.Measure(springs, i, state);
      for (int s = 0; s < kSpringBlock; ++s) {
        const Law law = block.Evaluate(springs, i, s, -V{});
        Store(law.length, length, kSpringBlock * i + s);
        Store(law.rate, rate, kSpringBlock * i + s);
      }
    }
  }

  static void AddSpringForces(const LaneSprings<Real>& springs, const Real* state, Real* force) {
    if (springs.direction == nullptr) {
      springs.tension != nullptr ? AddForces<true, false>(springs, state, force)
                                 : AddForces<false, false>(springs, state, force);
    } else {
      springs.tension != nullptr ? AddForces<true, true>(springs, state, force)
                                 : AddForces<false, true>(springs, state, force);
    }
  }

  // Several functions, so that springs without effects do not pay for them. A block is measured
  // before the forces of the one before it are added: else the processor would wait for the roots.
  template <bool kHasTension, bool kWantsDirections>
  static void AddForces(const LaneSprings<Real>& springs, const Real* state, Real* force) {
    if (springs.blocks == 0) return;
    Block even, odd;
    even.Measure(springs, 0, state);
    for (int i = 0; i < springs.blocks; i += 2) {
      odd.Measure(springs, i + 1, state);
      AddBlock<kHasTension, kWantsDirections>(springs, i, even, force);
      if (i + 2 < springs.blocks) even.Measure(springs, i + 2, state);
      AddBlock<kHasTension, kWantsDirections>(springs, i + 1, odd, force);
    }
  }

  // f_b += scale d, f_a -= the sum of the block
  template <bool kHasTension, bool kWantsDirections>
  static void AddBlock(const LaneSprings<Real>& springs, int i, const Block& block, Real* force) {
    Real* a = force + kLanes * kLaneForce * springs.a[i];
    const int* b = springs.b + kSpringBlock * i;
    V sum[3];
    for (int s = 0; s < kSpringBlock; s += 2) {
      V pair[2][3];
      for (int t = 0; t < 2; ++t) {
        V tension = -V{};
        if constexpr (kHasTension) tension = Load(springs.tension, kSpringBlock * i + s + t);
        const V scale = block.Evaluate(springs, i, s + t, tension).scale;
        Real* f = force + kLanes * kLaneForce * b[s + t];
        for (int j = 0; j < 3; ++j) {
          pair[t][j] = scale * block.d[s + t][j];
          if constexpr (kWantsDirections) {
            Store(block.d[s + t][j] * block.inverse[s + t], springs.direction,
                  3 * (kSpringBlock * i + s + t) + j);
          }
          Store(Load(f, j) + pair[t][j], f, j);
        }
      }
      for (int j = 0; j < 3; ++j) {
        const V both = pair[0][j] + pair[1][j];
        sum[j] = s == 0 ? both : sum[j] + both;
      }
    }
    for (int j = 0; j < 3; ++j) Store(Load(a, j) - sum[j], a, j);
  }

  static void AddDashpotForces(const LaneSprings<Real>& springs, const Real* velocity,
                               Real* force) {
    for (int i = 0; i < springs.blocks; ++i) {
      const Real* of_a = velocity + kLanes * kLaneForce * springs.a[i];
      const V v[3] = {Load(of_a, 0), Load(of_a, 1), Load(of_a, 2)};
      Real* a = force + kLanes * kLaneForce * springs.a[i];
      V sum[3];
      for (int s = 0; s < kSpringBlock; s += 2) {
        V pair[2][3];
        for (int t = 0; t < 2; ++t) {
          const int spring = kSpringBlock * i + s + t;
          const int b = kLanes * kLaneForce * springs.b[spring];
          V u[3], n[3];
          for (int j = 0; j < 3; ++j) {
            u[j] = v[j] - Load(velocity + b, j);
            n[j] = Load(springs.direction, 3 * spring + j);
          }
          const V scale = Load(springs.parameters, kLaneSpring * spring + 2) * Law::Dot(n, u);
          Real* f = force + b;
          for (int j = 0; j < 3; ++j) {
            pair[t][j] = scale * n[j];
            Store(Load(f, j) + pair[t][j], f, j);
          }
        }
        for (int j = 0; j < 3; ++j) {
          const V both = pair[0][j] + pair[1][j];
          sum[j] = s == 0 ? both : sum[j] + both;
        }
      }
      for (int j = 0; j < 3; ++j) Store(Load(a, j) - sum[j], a, j);
    }
  }

  static void AdvanceStage(const LaneNodes<Real>& nodes, const LaneStage<Real>& stage) {
    const V keep = Lanes::Set(stage.weights.keep), take = Lanes::Set(stage.weights.take);
    const V back = Lanes::Set(stage.weights.back), kick = Lanes::Set(stage.weights.kick);
    for (int i = 0; i < stage.columns; ++i) {
      for (int j = 0; j < 3; ++j) {
        const int at = kLaneForce * i + j;
        const V sum = Load(stage.force, at) + Load(stage.dashpots, at);
        const V next = (keep * Load(stage.effect, at) + take * sum) - back * Load(stage.before, at);
        Store(next, stage.next, at);
        Store(V{}, stage.dashpots, at);
        if (i >= nodes.nodes) continue;
        Store(next * Load(nodes.h_over_mass, i) + kick * Load(nodes.kick, j), stage.velocity, at);
      }
    }
  }

  static void UpdateVelocities(const LaneNodes<Real>& nodes, const Real* state, const Real* force,
                               Real* next) {
    const V decay = Load(nodes.decay, 0);
    const V kick[3] = {Load(nodes.kick, 0), Load(nodes.kick, 1), Load(nodes.kick, 2)};
    for (int i = 0; i < nodes.nodes; ++i) {
      const V h_over_mass = Load(nodes.h_over_mass, i);
      for (int j = 0; j < 3; ++j) {
        const int v = kLaneState * i + kLaneVelocity + j;
        const V p = Load(state, v) + (Load(force, kLaneForce * i + j) * h_over_mass + kick[j]);
        Store(p * decay, next, v);
      }
    }
  }

  static void UpdatePositions(const LaneNodes<Real>& nodes, const Real* state, Real* next) {
    const V h = Lanes::Set(nodes.h);
    for (int i = 0; i < nodes.nodes; ++i) {
      for (int j = 0; j < 3; ++j) {
        const int x = kLaneState * i + j;
        Store(Load(state, x) + h * Load(next, x + kLaneVelocity), next, x);
      }
    }
  }

  // Of vectors in space: OrderedDot of friction_cone.h. Of numbers: the greater and the lesser one,
  // the absolute one, and one kept within `most` of 0.
  static V Dot(const V (&a)[3], const V (&b)[3]) {
    return a[0] * b[0] + (a[1] * b[1] + a[2] * b[2]);
  }
  static V Max(V a, V b) { return a < b ? b : a; }
  static V Min(V a, V b) { return b < a ? b : a; }
  static V Abs(V a) { return (a < V{} ? -a : a) + V{}; }  // + 0 makes 0 of -0
  static V Clamp(V a, V most) { return a < -most ? -most : (most < a ? most : a); }

  // SlideElliptic and SlidePyramidal of friction_cone.h.
  static void SlideElliptic(V slowest, V limit, V (&u)[3]) {
    const V sliding = Max(Lanes::Sqrt(Dot(u, u)), slowest);
    const V kept = Max(V{}, Lanes::Set(1) - limit / sliding);
    for (V& one : u) one = kept * one;
  }
  static void SlidePyramidal(const V (&first)[3], const V (&second)[3], V limit, V (&u)[3]) {
    const V u1 = Dot(u, first), u2 = Dot(u, second);
    const V a = Abs(u1), b = Abs(u2);
    const V faster = Max(a, b), slower = Min(a, b);
    const V both = Max(V{}, (a + b - limit) / Lanes::Set(2));
    const V c = limit <= faster - slower ? faster - limit : both;
    for (int j = 0; j < 3; ++j) u[j] = Clamp(u1, c) * first[j] + Clamp(u2, c) * second[j];
  }

  static void SetAll(const Real (&numbers)[3], V (&all)[3]) {
    for (int j = 0; j < 3; ++j) all[j] = Lanes::Set(numbers[j]);
  }

  static void HitGround(const LaneNodes<Real>& nodes, const LaneGround<Real>& ground,
                        const Real* state, Real* next) {
    constexpr unsigned kAll = (1U << kLanes) - 1;
    V normal[3], first[3], second[3];
    SetAll(ground.normal, normal);
    SetAll(ground.tangents[0], first);
    SetAll(ground.tangents[1], second);
    const V offset = Lanes::Set(ground.offset), h = Lanes::Set(nodes.h);
    const V slowest = Lanes::Set(-ground.approach), sliding = Lanes::Set(ground.sliding);
    const V restitution = Load(ground.restitution, 0), friction = Load(ground.friction, 0);
    const V pyramidal = Load(ground.pyramidal, 0);
    const unsigned pyramids = Lanes::Less(V{}, pyramidal);
    for (int i = 0; i < nodes.nodes; ++i) {
      const Real* x = state + kLanes * kLaneState * i;
      Real* next_v = next + kLanes * (kLaneState * i + kLaneVelocity);
      const V place[3] = {Load(x, 0), Load(x, 1), Load(x, 2)};
      const V v[3] = {Load(next_v, 0), Load(next_v, 1), Load(next_v, 2)};
      const V approach = Dot(normal, v);
      const V after = Dot(normal, place) - offset - Load(ground.radius, i) + h * approach;
      if ((Lanes::Less(after, V{}) & Lanes::Less(approach, slowest)) == 0) continue;
      // Impact of contact_law.h
      V slides[3];
      for (int j = 0; j < 3; ++j) slides[j] = v[j] - approach * normal[j];
      const V limit = -friction * (Lanes::Set(1) + restitution) * approach;
      V on_pyramid[3] = {slides[0], slides[1], slides[2]};
      if (pyramids != kAll) SlideElliptic(sliding, limit, slides);
      if (pyramids != 0) SlidePyramidal(first, second, limit, on_pyramid);
      for (int j = 0; j < 3; ++j) {
        const V slid = V{} < pyramidal ? on_pyramid[j] : slides[j];
        const V hit =
            V{} + (-restitution * approach * normal[j] + slid);  // the ground stands still
        Store((after < V{}) & (approach < slowest) ? hit : v[j], next_v, j);
      }
    }
  }

  // In squares of numbers, and what is left over one by one.
  static void Interleave(const Real* const* rows, int count, Real* side_by_side) {
    constexpr int kSize = Lanes::Square::kSize;
    const int whole = count - count % kSize;
    for (int i = 0; i < whole; i += kSize) {
      for (int l = 0; l < kLanes; l += kSize) {
        typename Lanes::Square square;
        for (int k = 0; k < kSize; ++k) square.Load(rows[l + k] + i, k);
        square.Transpose();
        for (int k = 0; k < kSize; ++k) square.Store(side_by_side + kLanes * (i + k) + l, k);
      }
    }
    for (int i = whole; i < count; ++i) {
      for (int l = 0; l < kLanes; ++l) side_by_side[kLanes * i + l] = rows[l][i];
    }
  }
  static void Separate(const Real* side_by_side, int count, Real* const* rows) {
    constexpr int kSize = Lanes::Square::kSize;
    const int whole = count - count % kSize;
    for (int i = 0; i < whole; i += kSize) {
      for (int l = 0; l < kLanes; l += kSize) {
        typename Lanes::Square square;
        for (int k = 0; k < kSize; ++k) square.Load(side_by_side + kLanes * (i + k) + l, k);
        square.Transpose();
        for (int k = 0; k < kSize; ++k) square.Store(rows[l + k] + i, k);
      }
    }
    for (int i = whole; i < count; ++i) {
      for (int l = 0; l < kLanes; ++l) rows[l][i] = side_by_side[kLanes * i + l];
    }
  }

  static constexpr LaneKernel<Real> kKernel = {Lanes::kName,   kLanes,           Lanes::kTime,
                                               MeasureSprings, AddSpringForces,  AddDashpotForces,
                                               AdvanceStage,   UpdateVelocities, UpdatePositions,
                                               HitGround,      Interleave,       Separate};
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_LANE_KERNEL_VECTOR_H_
