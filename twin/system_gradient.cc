// SPDX-License-Identifier: Apache-2.0
#include "twin/system_gradient.h"

namespace physpring {

SystemGradient::SystemGradient(const SpringMassSystem& system)
    : stiffness(Eigen::VectorXd::Zero(system.spring_count())),
      rest_length(stiffness),
      dashpot(stiffness),
      mass(Eigen::VectorXd::Zero(system.node_count())) {
  for (const EffectValues& effect : system.effects) {
    effects.emplace_back(Eigen::VectorXd::Zero(effect.values.size()));
  }
}

SystemGradient& SystemGradient::operator+=(const SystemGradient& other) {
  stiffness += other.stiffness;
  rest_length += other.rest_length;
  dashpot += other.dashpot;
  mass += other.mass;
  drag += other.drag;
  gravity += other.gravity;
  contact += other.contact;
  for (std::size_t i = 0; i < effects.size(); ++i) effects[i] += other.effects[i];
  return *this;
}

}  // namespace physpring
