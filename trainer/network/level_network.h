// SPDX-License-Identifier: Apache-2.0
// The graph network on the last level of a twin: from weights to a corrected system, and back from
// derivatives with respect to that system to derivatives with respect to the weights.
#ifndef PHYSPRING_TRAINER_NETWORK_LEVEL_NETWORK_H_
#define PHYSPRING_TRAINER_NETWORK_LEVEL_NETWORK_H_

#include <vector>

#include "trainer/network/graph_network.h"
#include "twin/twin.h"

namespace physpring {

// The levels of a twin as the network takes them; they refer to the twin.
std::vector<GraphNetwork::Level> LevelsOf(const Twin& twin);

class LevelNetwork {
 public:
  // `base`: the system of the twin's last level that is corrected. The weights must outlive this.
  LevelNetwork(const GraphNetwork& network, const Twin& twin, const SpringMassSystem& base,
               const Eigen::VectorXd& weights);

  const SpringMassSystem& corrected() const { return corrected_; }
  Eigen::VectorXd Adjoint(const SystemGradient& gradient) const;

 private:
  Eigen::Index weight_count_;
  Tape tape_;
  GraphNetwork::Corrections corrections_;
  SpringMassSystem corrected_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_NETWORK_LEVEL_NETWORK_H_
