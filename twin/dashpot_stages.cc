// SPDX-License-Identifier: Apache-2.0
#include "twin/dashpot_stages.h"

#include <algorithm>
#include <array>
#include <utility>

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
  double before = 0, kick = 0;  // q_j-1, q_j
  for (int j = 0; j < stages; ++j) {
    double keep = 0, take = stages == 1 ? 1 : chebyshev.w1 / chebyshev.w0, back = 0;
    if (j > 0) {
      const double twice = 2 * T[j] / T[j + 1];
      keep = twice * chebyshev.w0;
      take = twice * chebyshev.w1;
      back = T[j - 1] / T[j + 1];
    }
    const double next = keep * kick + take - back * before;
    before = kick;
    kick = next;
    stages_.push_back({static_cast<Real>(keep), static_cast<Real>(take), static_cast<Real>(back),
                       static_cast<Real>(kick)});
  }
}

template <class Real>
void DashpotStages<Real>::Apply(const Kernel<Real>& kernel, const SpringView<Real>& springs,
                                const NodeView<Real>& nodes, NodeForces<Real>* force,
                                DashpotBuffers<Real>* buffers) const {
  if (count() == 1) return;
  const std::size_t columns = force->size();
  buffers->velocity.resize(stages_.size());
  buffers->next.resize(columns);
  for (NodeForces<Real>* zero : {&buffers->before, &buffers->effect, &buffers->dashpots}) {
    zero->assign(columns, {});
  }
  for (int j = 0; j < count(); ++j) {
    if (j > 0) {
      kernel.add_dashpot_forces(springs, buffers->velocity[j - 1].data(), buffers->dashpots.data());
    }
    NodeForces<Real>& velocity = buffers->velocity[j];
    velocity.resize(columns);  // controllers and the spare node: 0
    kernel.advance_stage(nodes, {stage(j), static_cast<int>(columns), force->data(),
                                 buffers->dashpots.data(), buffers->before.data(),
                                 buffers->effect.data(), buffers->next.data(), velocity.data()});
    std::swap(buffers->before, buffers->effect);
    std::swap(buffers->effect, buffers->next);
  }
  std::swap(*force, buffers->effect);
}

template <class Real>
void DashpotStages<Real>::ApplyAdjoint(const Kernel<Real>& kernel, const SpringView<Real>& dashpots,
                                       const NodeView<Real>& nodes, const NodeStates<Real>& state,
                                       NodeForces<Real>* force_bar, NodeStates<Real>* state_bar,
                                       Real* dashpot_bar, const NodeGradientView<Real>& gradient,
                                       DashpotBuffers<Real>* buffers) const {
  if (count() == 1) return;
  const std::size_t columns = force_bar->size();
  const auto springs = static_cast<std::size_t>(kSpringBlock) * dashpots.blocks;
  buffers->unused_stiffness.assign(springs, 0);
  buffers->unused_rest_length.assign(springs, 0);
  buffers->stage.assign(state.begin(), state.begin() + static_cast<std::ptrdiff_t>(columns));
  NodeForces<Real>&effect_bar = buffers->effect_bar, &before_bar = buffers->before_bar;
  effect_bar = *force_bar;  // d loss / d E_j+1, and / d E_j
  before_bar.assign(columns, {});
  buffers->sum_bar.assign(columns, {});
  force_bar->assign(columns, {});
  for (int j = count() - 1; j >= 0; --j) {
    const auto [keep, take, back, next_kick] = stage(j);
    // forward: E_j+1 = keep E_j + take (F + D R_j) - back E_j-1
    for (std::size_t i = 0; i < columns; ++i) {
      for (int k = 0; k < 3; ++k) {
        const Real bar = effect_bar[i].f[k];
        buffers->sum_bar[i].f[k] = take * bar;
        (*force_bar)[i].f[k] += take * bar;
        effect_bar[i].f[k] = before_bar[i].f[k] + keep * bar;
        before_bar[i].f[k] = -back * bar;
      }
    }
    if (j == 0) break;
    const NodeForces<Real>& velocity = buffers->velocity[j - 1];
    for (std::size_t i = 0; i < columns; ++i) {
      for (int k = 0; k < 3; ++k) buffers->stage[i].v[k] = velocity[i].f[k];
    }
    buffers->stage_bar.assign(columns, {});
    kernel.add_spring_forces_adjoint(
        dashpots, buffers->stage.data(), buffers->sum_bar.data(), buffers->stage_bar.data(),
        {buffers->unused_stiffness.data(), buffers->unused_rest_length.data(), dashpot_bar});
    for (std::size_t i = 0; i < columns; ++i) {
      for (int k = 0; k < 3; ++k) (*state_bar)[i].x[k] += buffers->stage_bar[i].x[k];
    }
    // forward: R_j = h / m E_j + q_j h g
    const Real kick = stage(j - 1).kick;
    for (int i = 0; i < nodes.nodes; ++i) {
      for (int k = 0; k < 3; ++k) {
        const Real bar = buffers->stage_bar[i].v[k];
        effect_bar[i].f[k] += nodes.h_over_mass[i] * bar;
        gradient.mass[i].f[k] += bar * (velocity[i].f[k] - kick * nodes.kick.f[k]);
        gradient.gravity->f[k] += kick * bar;
      }
    }
  }
}

template class DashpotStages<float>;
template class DashpotStages<double>;

}  // namespace physpring
