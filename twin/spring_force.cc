// SPDX-License-Identifier: Apache-2.0
#include "twin/spring_force.h"

#include <cmath>

namespace physpring {
namespace {

// Shorter than this a spring has no direction, and no force [m].
template <class Real>
constexpr Real kShortest = Real(1e-9);

template <class Real>
Real Dot(const Real* p, const Real* q) {
  return p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
}

}  // namespace

template <class Real>
void AddSpringForces(const SpringBlocks<Real>& springs, const NodeState<Real>* state,
                     NodeForce<Real>* force) {
  for (int i = 0; i < springs.size(); ++i) {
    const NodeState<Real>& a = state[springs.a[i]];
    const NodeState<Real>& b = state[springs.b[i]];
    Real d[3], u[3];
    for (int j = 0; j < 3; ++j) {
      d[j] = b.x[j] - a.x[j];
      u[j] = b.v[j] - a.v[j];
    }
    // F / l, so that the force is (F / l) d
    const Real length = std::max(std::sqrt(Dot(d, d)), kShortest<Real>);
    const Real inverse = Real(1) / length;
    const Real rate = Dot(d, u) * inverse;  // of change of the length
    const Real tension =
        springs.stiffness[i] * (length - springs.rest_length[i]) + springs.dashpot[i] * rate;
    const Real scale = tension * inverse;
    for (int j = 0; j < 3; ++j) {
      const Real f = scale * d[j];
      force[springs.a[i]].f[j] += f;
      force[springs.b[i]].f[j] -= f;
    }
  }
}

template <class Real>
void AddSpringForcesAdjoint(const SpringBlocks<Real>& springs, const NodeState<Real>* state,
                            const NodeForce<Real>* force_bar, NodeState<Real>* state_bar,
                            SpringBlockGradient<Real>* gradient) {
  for (int i = 0; i < springs.size(); ++i) {
    const int node_a = springs.a[i], node_b = springs.b[i];
    Real d[3], u[3], w[3];
    for (int j = 0; j < 3; ++j) {
      d[j] = state[node_b].x[j] - state[node_a].x[j];
      u[j] = state[node_b].v[j] - state[node_a].v[j];
      // forward: force_a += F n, force_b -= F n
      w[j] = force_bar[node_a].f[j] - force_bar[node_b].f[j];
    }
    const Real length = std::max(std::sqrt(Dot(d, d)), kShortest<Real>);
    const Real inverse = Real(1) / length;
    const Real rate = Dot(d, u) * inverse;
    const Real stretch = length - springs.rest_length[i];
    const Real tension = springs.stiffness[i] * stretch + springs.dashpot[i] * rate;
    const Real scale = tension * inverse;
    // loss = F (n . w):  F_bar = n . w
    const Real tension_bar = Dot(d, w) * inverse;
    // forward: F = k (l - L) + c rate
    gradient->stiffness[i] += tension_bar * stretch;
    gradient->rest_length[i] -= tension_bar * springs.stiffness[i];
    gradient->dashpot[i] += tension_bar * rate;
    const Real rate_bar = tension_bar * springs.dashpot[i] * inverse;  // over l
    // d_bar = n (k F_bar) + (I - n n^T) (F w + c F_bar u) / l, in terms of d = l n
    const Real along = (tension_bar * (springs.stiffness[i] - scale) - rate_bar * rate) * inverse;
    for (int j = 0; j < 3; ++j) {
      const Real d_bar = along * d[j] + scale * w[j] + rate_bar * u[j];
      const Real u_bar = rate_bar * d[j];
      state_bar[node_a].x[j] -= d_bar;
      state_bar[node_b].x[j] += d_bar;
      state_bar[node_a].v[j] -= u_bar;
      state_bar[node_b].v[j] += u_bar;
    }
  }
}

template void AddSpringForces<float>(const SpringBlocks<float>&, const NodeState<float>*,
                                     NodeForce<float>*);
template void AddSpringForces<double>(const SpringBlocks<double>&, const NodeState<double>*,
                                      NodeForce<double>*);
template void AddSpringForcesAdjoint<float>(const SpringBlocks<float>&, const NodeState<float>*,
                                            const NodeForce<float>*, NodeState<float>*,
                                            SpringBlockGradient<float>*);
template void AddSpringForcesAdjoint<double>(const SpringBlocks<double>&, const NodeState<double>*,
                                             const NodeForce<double>*, NodeState<double>*,
                                             SpringBlockGradient<double>*);

}  // namespace physpring
