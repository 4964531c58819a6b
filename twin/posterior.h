// SPDX-License-Identifier: Apache-2.0
// What the recordings leave open of a twin: a normal distribution about its level 0 (Laplace's
// approximation of the posterior), from which twins can be drawn. Each row of the matrices is a
// direction in which level 0 may differ from the truth, by one standard deviation; directions are
// independent. Along z standard normal numbers z_k,
//   stiffness_e   = fitted exp(sum_k z_k stiffness(k, e))
//   dashpot_e     = stiffness_e x fitted loss time exp(sum_k z_k loss_time(k, e))
//   drag, contact   likewise, factors exp(sum_k z_k ...)
//   effects       : values with a logarithmic spacing likewise, to others sum_k z_k ... is added
// Values stay within their bounds. Coarser levels follow: a spring's factor is the mean of those of
// the springs of level 0 that it stands for, weighted by stiffness.
#ifndef PHYSPRING_TWIN_POSTERIOR_H_
#define PHYSPRING_TWIN_POSTERIOR_H_

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "twin/spring_mass_system.h"

namespace physpring {

struct Twin;

struct Posterior {
  Eigen::MatrixXd stiffness;  // (directions, springs) of level 0, logarithms
  Eigen::MatrixXd loss_time;  // (directions, springs), logarithms
  Eigen::VectorXd drag;       // (directions), logarithms
  Eigen::MatrixXd contact;    // (directions, kContactCount) against ground and geoms, logarithms
  Eigen::MatrixXd effects;    // (directions, values of all effects)

  int size() const { return static_cast<int>(stiffness.rows()); }
  bool empty() const { return size() == 0; }
};

// Level 0 at these standard normal numbers, (posterior.size()).
SpringMassSystem MovedAlong(const Posterior& posterior, const SpringMassSystem& system,
                            const Eigen::VectorXd& numbers);

// Sample `index` of a twin: the same for the same seed, whatever other samples are drawn. A level
// that needs more sub-steps than it was trained with gets them; springs that would need more than
// twice as many are softened. Its own posterior, material and state of training are left out.
// Throws Error if the twin has no posterior, or one that leads to numbers which no twin has.
Twin SampleOf(const Twin& twin, std::uint64_t seed, int index);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_POSTERIOR_H_
