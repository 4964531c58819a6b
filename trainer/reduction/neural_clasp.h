// SPDX-License-Identifier: Apache-2.0
// Neural-CLASP (paper, section 3.2.1): which nodes are joined is decided by the distances of their
// latent features. A node i goes to a spring neighbour j, or stays, with the probabilities
//   P_ij = softmax_j (-D_ij / lambda),   D_ij = |h_i - h_j|,   j: the spring neighbours and i
//   itself.
// One such choice is drawn by adding lambda times Gumbel noise to -D (none at the end), and hard
// clusters are made of it: the best-scored choices first, each node at most once and only to a node
// that stays, until exactly the budget is left; the last score taken is the logit of staying. Where
// the choices do not suffice, the clusters choose again among themselves.
//
// What the features learn from is how well the levels that are drawn predict the recordings
// (topology_fit.h): d log P / d D of a whole choice makes good draws more likely (the score
// function of Williams, Machine Learning 8, 1992).
#ifndef PHYSPRING_TRAINER_REDUCTION_NEURAL_CLASP_H_
#define PHYSPRING_TRAINER_REDUCTION_NEURAL_CLASP_H_

#include <array>
#include <random>
#include <vector>

#include "trainer/reduction/clusters.h"
#include "twin/spring_mass_system.h"

namespace physpring {

// The springs between free nodes, as pairs.
std::vector<std::array<int, 2>> FreePairs(const SpringMassSystem& system);

// Scores -D + lambda g of both directions of each pair (first to second, then second to first).
Eigen::MatrixX2d DrawScores(const Eigen::VectorXd& distance, double temperature,
                            std::mt19937_64* random);

// Hard clusters from the scores, and what each node chose in the first round: 2 pair + way, or
// kStays.
struct Choice {
  static constexpr int kStays = -1;
  Assignment assignment;
  std::vector<int> chosen;
  double stay = 0;  // the score that staying had
};
Choice ChooseClusters(const SpringMassSystem& system, const Eigen::MatrixX2d& scores, int nodes);

// d log P / d D of all nodes' first choices together, one row a pair; the score of staying is held.
Eigen::VectorXd LogProbabilityGradient(const SpringMassSystem& system,
                                       const Eigen::VectorXd& distance, const Choice& choice,
                                       double temperature);

// log P, of which that is the gradient.
double LogProbability(const SpringMassSystem& system, const Eigen::VectorXd& distance,
                      const Choice& choice, double temperature);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_REDUCTION_NEURAL_CLASP_H_
