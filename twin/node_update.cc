// SPDX-License-Identifier: Apache-2.0
#include "twin/node_update.h"

namespace physpring {

template <class Real>
void UpdateVelocities(const NodeView<Real>& nodes, const NodeState<Real>* state,
                      const NodeForce<Real>* force, NodeState<Real>* next) {
  for (int i = 0; i < nodes.nodes; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Real p = state[i].v[j] + (force[i].f[j] * nodes.h_over_mass[i] + nodes.kick.f[j]);
      next[i].v[j] = p * nodes.decay;
    }
  }
}

template <class Real>
void UpdatePositions(const NodeView<Real>& nodes, const NodeState<Real>* state,
                     NodeState<Real>* next) {
  for (int i = 0; i < nodes.nodes; ++i) {
    for (int j = 0; j < 3; ++j) next[i].x[j] = state[i].x[j] + nodes.h * next[i].v[j];
  }
}

template <class Real>
void AdvanceStage(const NodeView<Real>& nodes, const StageView<Real>& stage) {
  const auto [keep, take, back, kick] = stage.weights;
  for (int i = 0; i < stage.columns; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Real sum = stage.force[i].f[j] + stage.dashpots[i].f[j];
      const Real next = (keep * stage.effect[i].f[j] + take * sum) - back * stage.before[i].f[j];
      stage.next[i].f[j] = next;
      stage.dashpots[i].f[j] = 0;
      if (i >= nodes.nodes) continue;
      stage.velocity[i].f[j] = next * nodes.h_over_mass[i] + kick * nodes.kick.f[j];
    }
  }
}

template <class Real>
void UpdatePositionsAdjoint(const NodeView<Real>& nodes, NodeState<Real>* state_bar) {
  for (int i = 0; i < nodes.nodes; ++i) {
    // forward: x' = x + h v'
    for (int j = 0; j < 3; ++j) state_bar[i].v[j] += nodes.h * state_bar[i].x[j];
  }
}

template <class Real>
void UpdateVelocitiesAdjoint(const NodeView<Real>& nodes, const NodeState<Real>* state,
                             const NodeState<Real>* next, NodeState<Real>* state_bar,
                             NodeForce<Real>* force_bar, const NodeGradientView<Real>& gradient) {
  const Real inverse_decay = 1 / nodes.decay;
  for (int i = 0; i < nodes.nodes; ++i) {
    for (int j = 0; j < 3; ++j) {
      // forward: v' = p exp(-h drag)
      const Real p = next[i].v[j] * inverse_decay;
      const Real p_bar = state_bar[i].v[j] * nodes.decay;
      gradient.drag->f[j] += next[i].v[j] * state_bar[i].v[j];
      // forward: p = v + (F h / m + h g)
      gradient.mass[i].f[j] += p_bar * (p - state[i].v[j] - nodes.kick.f[j]);
      gradient.gravity->f[j] += p_bar;
      force_bar[i].f[j] = p_bar * nodes.h_over_mass[i];
      state_bar[i].v[j] = p_bar;
    }
  }
}

template void AdvanceStage(const NodeView<float>&, const StageView<float>&);
template void AdvanceStage(const NodeView<double>&, const StageView<double>&);
template void UpdateVelocities(const NodeView<float>&, const NodeState<float>*,
                               const NodeForce<float>*, NodeState<float>*);
template void UpdateVelocities(const NodeView<double>&, const NodeState<double>*,
                               const NodeForce<double>*, NodeState<double>*);
template void UpdatePositions(const NodeView<float>&, const NodeState<float>*, NodeState<float>*);
template void UpdatePositions(const NodeView<double>&, const NodeState<double>*,
                              NodeState<double>*);
template void UpdatePositionsAdjoint(const NodeView<float>&, NodeState<float>*);
template void UpdatePositionsAdjoint(const NodeView<double>&, NodeState<double>*);
template void UpdateVelocitiesAdjoint(const NodeView<float>&, const NodeState<float>*,
                                      const NodeState<float>*, NodeState<float>*, NodeForce<float>*,
                                      const NodeGradientView<float>&);
template void UpdateVelocitiesAdjoint(const NodeView<double>&, const NodeState<double>*,
                                      const NodeState<double>*, NodeState<double>*,
                                      NodeForce<double>*, const NodeGradientView<double>&);

}  // namespace physpring
