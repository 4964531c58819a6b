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
struct Spring {
  SpringLaw<OneLane<Real>> law;
  Real d[3], u[3];
};

// Spring i between nodes a and b, evaluated.
template <class Real>
Spring<Real> Evaluate(SpringView<Real> springs, int i, const NodeState<Real>& a,
                      const NodeState<Real>& b) {
  Spring<Real> spring;
  spring.law.k = springs.stiffness[i];
  spring.law.L = springs.rest_length[i];
  spring.law.c = springs.dashpot[i];
  if (springs.tension != nullptr) spring.law.T = springs.tension[i];
  for (int j = 0; j < 3; ++j) {
    spring.d[j] = a.x[j] - b.x[j];
    spring.u[j] = a.v[j] - b.v[j];
  }
  spring.law.Evaluate(spring.law.Dot(spring.d, spring.d), spring.law.Dot(spring.d, spring.u));
  return spring;
}

// w = f_a - f_b
template <class Real>
void Subtract(const NodeForce<Real>& a, const NodeForce<Real>& b, Real* w) {
  for (int j = 0; j < 3; ++j) w[j] = a.f[j] - b.f[j];
}

// The four springs of a block, added pairwise: a pair fits into a vector operation.
template <class Real>
Real Sum(const Real (&value)[kSpringBlock]) {
  return (value[0] + value[1]) + (value[2] + value[3]);
}

}  // namespace

template <class Real>
void MeasureSprings(SpringView<Real> springs, const NodeState<Real>* state,
                    const NodeForce<Real>* force_bar, SpringMeasures<Real> measures) {
  for (int i = 0; i < kSpringBlock * springs.blocks; ++i) {
    const int a = springs.a[i / kSpringBlock], b = springs.b[i];
    const Spring<Real> spring = Evaluate(springs, i, state[a], state[b]);
    measures.length[i] = spring.law.length;
    measures.rate[i] = spring.law.rate;
    if (force_bar == nullptr) continue;
    Real w[3];
    Subtract(force_bar[a], force_bar[b], w);
    measures.tension_bar[i] = spring.law.TensionBar(spring.law.Dot(spring.d, w));
  }
}

template <class Real>
void AddSpringForces(SpringView<Real> springs, const NodeState<Real>* state,
                     NodeForce<Real>* force) {
  const int count = kSpringBlock * springs.blocks;
  for (int block = 0; block < springs.blocks; ++block) {
    const int a = springs.a[block];
    Real on_b[3][kSpringBlock];
    for (int s = 0; s < kSpringBlock; ++s) {
      const int i = kSpringBlock * block + s, b = springs.b[i];
      const Spring<Real> spring = Evaluate(springs, i, state[a], state[b]);
      for (int j = 0; j < 3; ++j) {
        on_b[j][s] = spring.law.scale * spring.d[j];
        force[b].f[j] += on_b[j][s];
        if (springs.direction != nullptr) {
          springs.direction[count * j + i] = spring.d[j] * spring.law.inverse;
        }
      }
    }
    for (int j = 0; j < 3; ++j) force[a].f[j] -= Sum(on_b[j]);
  }
}

template <class Real>
void AddSpringForcesAdjoint(SpringView<Real> springs, const NodeState<Real>* state,
                            const NodeForce<Real>* force_bar, NodeState<Real>* state_bar,
                            SpringGradientView<Real> gradient) {
  for (int block = 0; block < springs.blocks; ++block) {
    const int a = springs.a[block];
    Real x_bar[3][kSpringBlock], v_bar[3][kSpringBlock];
    for (int s = 0; s < kSpringBlock; ++s) {
      const int i = kSpringBlock * block + s, b = springs.b[i];
      Spring<Real> spring = Evaluate(springs, i, state[a], state[b]);
      auto& [law, d, u] = spring;
      Real w[3];
      Subtract(force_bar[a], force_bar[b], w);
      if (springs.tension != nullptr) {
        law.length_bar = gradient.length[i];
        law.rate_bar = gradient.rate[i];
      }
      law.Differentiate(law.Dot(d, w), &gradient.stiffness[i], &gradient.rest_length[i],
                        &gradient.dashpot[i]);
      for (int j = 0; j < 3; ++j) {
        x_bar[j][s] = law.along * d[j] + law.scale * w[j] + law.damping * u[j];
        v_bar[j][s] = law.damping * d[j];
        state_bar[b].x[j] += x_bar[j][s];
        state_bar[b].v[j] += v_bar[j][s];
      }
    }
    for (int j = 0; j < 3; ++j) {
      state_bar[a].x[j] -= Sum(x_bar[j]);
      state_bar[a].v[j] -= Sum(v_bar[j]);
    }
  }
}

template <class Real>
void AddDashpotForces(SpringView<Real> springs, const NodeForce<Real>* velocity,
                      NodeForce<Real>* force) {
  const int count = kSpringBlock * springs.blocks;
  for (int block = 0; block < springs.blocks; ++block) {
    const int a = springs.a[block];
    Real on_b[3][kSpringBlock];
    for (int s = 0; s < kSpringBlock; ++s) {
      const int i = kSpringBlock * block + s, b = springs.b[i];
      Real u[3], n[3];
      Subtract(velocity[a], velocity[b], u);
      for (int j = 0; j < 3; ++j) n[j] = springs.direction[count * j + i];
      const Real scale = springs.dashpot[i] * SpringLaw<OneLane<Real>>::Dot(n, u);
      for (int j = 0; j < 3; ++j) {
        on_b[j][s] = scale * n[j];
        force[b].f[j] += on_b[j][s];
      }
    }
    for (int j = 0; j < 3; ++j) force[a].f[j] -= Sum(on_b[j]);
  }
}

template void MeasureSprings(SpringView<float>, const NodeState<float>*, const NodeForce<float>*,
                             SpringMeasures<float>);
template void MeasureSprings(SpringView<double>, const NodeState<double>*, const NodeForce<double>*,
                             SpringMeasures<double>);
template void AddSpringForces(SpringView<float>, const NodeState<float>*, NodeForce<float>*);
template void AddSpringForces(SpringView<double>, const NodeState<double>*, NodeForce<double>*);
template void AddSpringForcesAdjoint(SpringView<float>, const NodeState<float>*,
                                     const NodeForce<float>*, NodeState<float>*,
                                     SpringGradientView<float>);
template void AddSpringForcesAdjoint(SpringView<double>, const NodeState<double>*,
                                     const NodeForce<double>*, NodeState<double>*,
                                     SpringGradientView<double>);
template void AddDashpotForces(SpringView<float>, const NodeForce<float>*, NodeForce<float>*);
template void AddDashpotForces(SpringView<double>, const NodeForce<double>*, NodeForce<double>*);

}  // namespace physpring
