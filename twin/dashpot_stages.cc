// SPDX-License-Identifier: Apache-2.0
#include "twin/dashpot_stages.h"

#include <algorithm>
#include <array>

namespace physpring {
namespace {

// T_0 ... T_s at w0, and w1.
struct Chebyshev {
  double w0, w1;
  std::vector<double> value;

  explicit Chebyshev(int stages) : w0(1 + 1.0 / (stages * stages)), value{1, w0} {
    std::vector<double> slope{0, 1};
    for (int j = 1; j < stages; ++j) {
      slope.push_back(2 * value[j] + 2 * w0 * slope[j] - slope[j - 1]);
      value.push_back(2 * w0 * value[j] - value[j - 1]);
    }
    w1 = value[stages] / slope[stages];
  }

  // P(z)
  double Damped(double z) const {
    const double y = w0 - w1 * z;
    double before = 1, now = y;
    for (std::size_t j = 2; j < value.size(); ++j) {
      const double next = 2 * y * now - before;
      before = now;
      now = next;
    }
    return now / value.back();
  }
};

// A sub-step is one of semi-implicit Euler with the mass M / Q, Q = (1 - P(z)) / z <= 1, where
// h^2 K + 2 h C < 4 M / Q. So h^2 K + 2 h (C - D) < 2 M (1 + P) / Q, here at its least.
DashpotLimits FindLimits(int stages) {
  constexpr int kPoints = 1000;
  const Chebyshev chebyshev(stages);
  const double damping = (1 + chebyshev.w0) / chebyshev.w1;
  double stiffness = 4;
  for (int i = 1; i <= kPoints; ++i) {
    const double z = damping * i / kPoints, damped = chebyshev.Damped(z);
    stiffness = std::min(stiffness, 2 * (1 + damped) * z / (1 - damped));
  }
  return {damping, 0.999 * stiffness};
}

}  // namespace

DashpotLimits LimitsOfStages(int stages) {
  static const auto kLimits = [] {
    std::array<DashpotLimits, kMostDashpotStages + 1> limits{};
    limits[1] = {2, 4};
    for (int s = 2; s <= kMostDashpotStages; ++s) limits[s] = FindLimits(s);
    return limits;
  }();
  return kLimits[stages];
}

template <class Real>
DashpotStages<Real>::DashpotStages(int stages) {
  const Chebyshev chebyshev(stages);
  const std::vector<double>& T = chebyshev.value;
  const double first = stages == 1 ? 1 : chebyshev.w1 / chebyshev.w0;
  double before = 0, kick = first;  // q_j-1, q_j
  for (int j = 1; j <= stages; ++j) {
    DashpotStage<Real> stage{static_cast<Real>(kick), 0, 0, 0};
    if (j < stages) {
      const double twice = 2 * T[j] / T[j + 1], back = T[j - 1] / T[j + 1];
      const double keep = twice * chebyshev.w0, take = twice * chebyshev.w1;
      stage.keep = static_cast<Real>(keep);
      stage.take = static_cast<Real>(take);
      stage.back = static_cast<Real>(back);
      const double next = keep * kick + take - back * before;
      before = kick;
      kick = next;
    }
    stages_.push_back(stage);
  }
}

template <class Real>
void DashpotStages<Real>::Apply(const Kernel<Real>& kernel, const SpringView<Real>& dashpots,
                                const NodeView<Real>& nodes, const NodeStates<Real>& state,
                                NodeForces<Real>* force, DashpotBuffers<Real>* buffers) const {
  const int stages = count();
  if (stages == 1) return;
  const std::size_t columns = force->size();
  buffers->stage.resize(stages - 1);
  buffers->effect.resize(stages + 1);
  for (NodeForces<Real>& effect : buffers->effect) effect.resize(columns);
  std::fill(buffers->effect[0].begin(), buffers->effect[0].end(), NodeForce<Real>{});
  for (std::size_t i = 0; i < columns; ++i) {
    for (int k = 0; k < 3; ++k) buffers->effect[1][i].f[k] = first() * (*force)[i].f[k];
  }
  for (int j = 1; j < stages; ++j) {
    const auto [kick, keep, take, back] = stage(j);
    const NodeForces<Real>&effect = buffers->effect[j], &before = buffers->effect[j - 1];
    NodeStates<Real>& at = buffers->stage[j - 1];
    at.resize(columns);
    for (std::size_t i = 0; i < columns; ++i) {
      for (int k = 0; k < 3; ++k) at[i].x[k] = state[i].x[k];
    }
    for (int i = 0; i < nodes.nodes; ++i) {
      for (int k = 0; k < 3; ++k) {
        at[i].v[k] = nodes.h_over_mass[i] * effect[i].f[k] + kick * nodes.kick.f[k];
      }
    }
    buffers->force = *force;
    kernel.add_spring_forces(dashpots, at.data(), buffers->force.data());
    NodeForces<Real>& next = buffers->effect[j + 1];
    for (std::size_t i = 0; i < columns; ++i) {
      for (int k = 0; k < 3; ++k) {
        next[i].f[k] =
            (keep * effect[i].f[k] + take * buffers->force[i].f[k]) - back * before[i].f[k];
      }
    }
  }
  *force = buffers->effect[stages];
}

template <class Real>
void DashpotStages<Real>::ApplyAdjoint(const Kernel<Real>& kernel, const SpringView<Real>& dashpots,
                                       const NodeView<Real>& nodes, NodeForces<Real>* force_bar,
                                       NodeStates<Real>* state_bar, Real* dashpot_bar,
                                       const NodeGradientView<Real>& gradient,
                                       DashpotBuffers<Real>* buffers) const {
  const int stages = count();
  if (stages == 1) return;
  const std::size_t columns = force_bar->size();
  std::vector<NodeForces<Real>>& effect_bar = buffers->effect_bar;
  effect_bar.assign(stages + 1, NodeForces<Real>(columns));
  effect_bar[stages] = *force_bar;
  buffers->force_bar.assign(columns, {});
  buffers->stage_force_bar.assign(columns, {});
  const auto springs = static_cast<std::size_t>(kSpringBlock) * dashpots.blocks;
  buffers->unused_stiffness.assign(springs, 0);
  buffers->unused_rest_length.assign(springs, 0);
  for (int j = stages - 1; j >= 1; --j) {
    const auto [kick, keep, take, back] = stage(j);
    // forward: E_j+1 = keep E_j + take G_j - back E_j-1
    for (std::size_t i = 0; i < columns; ++i) {
      for (int k = 0; k < 3; ++k) {
        const Real bar = effect_bar[j + 1][i].f[k];
        effect_bar[j][i].f[k] += keep * bar;
        effect_bar[j - 1][i].f[k] -= back * bar;
        buffers->stage_force_bar[i].f[k] = take * bar;
        buffers->force_bar[i].f[k] += take * bar;
      }
    }
    // forward: G_j = F + D(x) R_j
    buffers->stage_bar.assign(columns, {});
    kernel.add_spring_forces_adjoint(
        dashpots, buffers->stage[j - 1].data(), buffers->stage_force_bar.data(),
        buffers->stage_bar.data(),
        {buffers->unused_stiffness.data(), buffers->unused_rest_length.data(), dashpot_bar});
    for (std::size_t i = 0; i < columns; ++i) {
      for (int k = 0; k < 3; ++k) (*state_bar)[i].x[k] += buffers->stage_bar[i].x[k];
    }
    // forward: R_j = h / m E_j + q_j h g
    for (int i = 0; i < nodes.nodes; ++i) {
      for (int k = 0; k < 3; ++k) {
        const Real bar = buffers->stage_bar[i].v[k];
        effect_bar[j][i].f[k] += nodes.h_over_mass[i] * bar;
        gradient.mass[i].f[k] += bar * (nodes.h_over_mass[i] * buffers->effect[j][i].f[k]);
        gradient.gravity->f[k] += kick * bar;
      }
    }
  }
  for (std::size_t i = 0; i < columns; ++i) {
    for (int k = 0; k < 3; ++k) {
      (*force_bar)[i].f[k] = buffers->force_bar[i].f[k] + first() * effect_bar[1][i].f[k];
    }
  }
}

template class DashpotStages<float>;
template class DashpotStages<double>;

}  // namespace physpring
