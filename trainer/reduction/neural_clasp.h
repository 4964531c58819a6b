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
// What the features learn from is the motion of level 0: the loss of an assignment is the mean
// squared distance of its particles from themselves averaged to clusters and lifted again, the
// least error that a level with these clusters can have. Its gradient goes straight through the
// hard choice: the derivative with respect to P_ij is the one of carrying i's particles by j's
// cluster.
#ifndef PHYSPRING_TRAINER_REDUCTION_NEURAL_CLASP_H_
#define PHYSPRING_TRAINER_REDUCTION_NEURAL_CLASP_H_

#include <array>
#include <random>
#include <vector>

#include "trainer/reduction/assignment.h"
#include "twin/twin.h"

namespace physpring {

// The springs between free nodes, as pairs.
std::vector<std::array<int, 2>> FreePairs(const SpringMassSystem& system);

// Scores -D + lambda g of both directions of each pair (first to second, then second to first).
Eigen::MatrixX2d DrawScores(const Eigen::VectorXd& distance, double temperature,
                            std::mt19937_64* random);

// Hard clusters from the scores.
struct Choice {
  Assignment assignment;
  double stay = 0;  // the score that staying had
};
Choice ChooseClusters(const SpringMassSystem& system, const Eigen::MatrixX2d& scores, int nodes);

// Motions of level 0's particles: where they start, and some of the frames (3 x particles, m).
struct ParticleMotion {
  Points start;
  std::vector<Points> frames;
};

class ProjectionLoss {
 public:
  // Of assignments of the last level of `twin`. `up` as in Project.
  ProjectionLoss(const Twin& twin, std::vector<ParticleMotion> motions, const Eigen::Vector3d& up);

  // Root mean square over particles and frames, m.
  double Error(const Assignment& assignment) const;

  // d log(mean square) / d D (pairs), for the assignment that was chosen from the scores.
  Eigen::VectorXd DistanceGradient(const Choice& choice, const Eigen::MatrixX2d& scores,
                                   double temperature) const;

 private:
  Twin WithLevel(const Assignment& assignment) const;

  Twin twin_;
  std::vector<int> owner_;  // the last level's node of each particle
  std::vector<ParticleMotion> motions_;
  Eigen::Vector3d up_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_REDUCTION_NEURAL_CLASP_H_
