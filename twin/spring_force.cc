// SPDX-License-Identifier: Apache-2.0
#include "twin/spring_force.h"

#include <cmath>

#include "twin/spring_law.h"

namespace physpring {
namespace {

template <class Real>
struct OneLane {
  using V = Real;
  static V Sqrt(V x) { return std::sqrt(x); }
  static V Inverse(V length) { return length >= Real(kShortest) ? 1 / length : 0; }
};

template <class Real>
using Spring = SpringLaw<OneLane<Real>>;

// Spring i between a and springs.b[i], evaluated.
template <class Real>
Spring<Real> Evaluate(const SpringView<Real>& springs, int i, const NodeState<Real>& a,
                      const NodeState<Real>& b) {
  Spring<Real> spring;
  spring.k = springs.stiffness[i];
  spring.L = springs.rest_length[i];
  spring.c = springs.dashpot[i];
  for (int j = 0; j < 3; ++j) {
    spring.d[j] = a.x[j] - b.x[j];
    spring.u[j] = a.v[j] - b.v[j];
  }
  spring.Evaluate();
  return spring;
}

// The four springs of a block, added pairwise: a pair fits into a vector operation.
template <class Real>
Real Sum(const Real (&value)[kSpringBlock]) {
  return (value[0] + value[1]) + (value[2] + value[3]);
}

}  // namespace

template <class Real>
void AddSpringForces(const SpringView<Real>& springs, const NodeState<Real>* state,
                     NodeForce<Real>* force) {
  for (int block = 0; block < springs.blocks; ++block) {
    const int a = springs.a[block];
    Real on_b[3][kSpringBlock];
    for (int s = 0; s < kSpringBlock; ++s) {
      const int i = kSpringBlock * block + s, b = springs.b[i];
      const Spring<Real> spring = Evaluate(springs, i, state[a], state[b]);
      for (int j = 0; j < 3; ++j) {
        on_b[j][s] = spring.scale * spring.d[j];
        force[b].f[j] += on_b[j][s];
      }
    }
    for (int j = 0; j < 3; ++j) force[a].f[j] -= Sum(on_b[j]);
  }
}

template <class Real>
void AddSpringForcesAdjoint(const SpringView<Real>& springs, const NodeState<Real>* state,
                            const NodeForce<Real>* force_bar, NodeState<Real>* state_bar,
                            const SpringGradientView<Real>& gradient) {
  for (int block = 0; block < springs.blocks; ++block) {
    const int a = springs.a[block];
    Real x_bar[3][kSpringBlock], v_bar[3][kSpringBlock];
    for (int s = 0; s < kSpringBlock; ++s) {
      const int i = kSpringBlock * block + s, b = springs.b[i];
      const Spring<Real> spring = Evaluate(springs, i, state[a], state[b]);
      Real w[3], b_x_bar[3], b_v_bar[3];
      for (int j = 0; j < 3; ++j) w[j] = force_bar[a].f[j] - force_bar[b].f[j];
      spring.Differentiate(w, &gradient.stiffness[i], &gradient.rest_length[i],
                           &gradient.dashpot[i], b_x_bar, b_v_bar);
      for (int j = 0; j < 3; ++j) {
        state_bar[b].x[j] += x_bar[j][s] = b_x_bar[j];
        state_bar[b].v[j] += v_bar[j][s] = b_v_bar[j];
      }
    }
    for (int j = 0; j < 3; ++j) {
      state_bar[a].x[j] -= Sum(x_bar[j]);
      state_bar[a].v[j] -= Sum(v_bar[j]);
    }
  }
}

template void AddSpringForces(const SpringView<float>&, const NodeState<float>*, NodeForce<float>*);
template void AddSpringForces(const SpringView<double>&, const NodeState<double>*,
                              NodeForce<double>*);
template void AddSpringForcesAdjoint(const SpringView<float>&, const NodeState<float>*,
                                     const NodeForce<float>*, NodeState<float>*,
                                     const SpringGradientView<float>&);
template void AddSpringForcesAdjoint(const SpringView<double>&, const NodeState<double>*,
                                     const NodeForce<double>*, NodeState<double>*,
                                     const SpringGradientView<double>&);

}  // namespace physpring
