// SPDX-License-Identifier: Apache-2.0
// The Galerkin projection of a spring-mass system onto clusters of its nodes (P: one column a
// cluster, controllers each their own):
//   mass       M_I = sum_i m_i                       P^T M P
//   position   X_I = sum_i m_i x_i / M_I
//   stiffness  K_IJ = sum_e k_e,  C_IJ = sum_e c_e   off the diagonal of P^T L P and P^T D P, over
//                                                    the springs e between I and J, in N/m
//   drag       the same rate
// What the scalar Laplacian does not say is chosen so that the coarse system rests where the fine
// one does: a coarse spring pulls in the reference configuration as hard, along itself, as the fine
// ones it stands for,
//   K (|D| - L) = sum_e k_e (|d_e| - L_e) n_e . N.
// A cluster touches a surface where the lowest of its members would: its contact radius is the
// greatest of r_i + up . (X_I - x_i).
// The projection by the identity is the system itself, bit for bit.
#ifndef PHYSPRING_TRAINER_PROJECTION_GALERKIN_H_
#define PHYSPRING_TRAINER_PROJECTION_GALERKIN_H_

#include <vector>

#include "trainer/projection/assignment.h"
#include "twin/spring_mass_system.h"

namespace physpring {

struct Projection {
  SpringMassSystem system;
  std::vector<int> spring;  // the coarse spring that each fine one is part of; -1: in a cluster
};

// `up`: away from the ground, unit length.
Projection Project(const SpringMassSystem& fine, const Assignment& assignment,
                   const Eigen::Vector3d& up);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_PROJECTION_GALERKIN_H_
