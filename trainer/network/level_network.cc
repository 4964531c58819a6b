// SPDX-License-Identifier: Apache-2.0
#include "trainer/network/level_network.h"

namespace physpring {

std::vector<GraphNetwork::Level> LevelsOf(const Twin& twin) {
  std::vector<GraphNetwork::Level> levels{{&twin.levels[0].system, {}, {}}};
  for (std::size_t l = 1; l < twin.levels.size(); ++l) {
    const TwinLevel& level = twin.levels[l];
    // where springs go does not depend on which way is up
    levels.push_back(
        {&level.system, level.assignment,
         Project(twin.levels[l - 1].system, level.assignment, Eigen::Vector3d::UnitZ()).spring});
  }
  return levels;
}

LevelNetwork::LevelNetwork(const GraphNetwork& network, const Twin& twin,
                           const SpringMassSystem& base, const Eigen::VectorXd& weights)
    : weight_count_(weights.size()),
      tape_(weights),
      corrections_(network.Decode(base, network.Encode(LevelsOf(twin), &tape_), &tape_)),
      corrected_(ApplyCorrections(base, tape_.value(corrections_.springs),
                                  tape_.value(corrections_.system))) {}

Eigen::VectorXd LevelNetwork::Adjoint(const SystemGradient& gradient) const {
  Features springs_bar, system_bar;
  CorrectionsAdjoint(corrected_, gradient, &springs_bar, &system_bar);
  Eigen::VectorXd weights_bar = Eigen::VectorXd::Zero(weight_count_);
  tape_.Backward({{corrections_.springs, springs_bar}, {corrections_.system, system_bar}},
                 &weights_bar);
  return weights_bar;
}

}  // namespace physpring
