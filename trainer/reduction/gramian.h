// SPDX-License-Identifier: Apache-2.0
// Clustering by the controllability Gramian of the second-order network (Cheng, Kawano and
// Scherpen, IEEE TAC 2017):
//   M x.. + D x. + L x = F u,  u: the controllers' displacements,  F_ic = k_ic.
// Two nodes are alike if their responses to impulses of the inputs are:
//   D_ij^2 = integral |x_i(t) - x_j(t)|^2 dt = (e_i - e_j)^T P (e_i - e_j),
// P the position block of the Gramian. It is clustered by average linkage over springs.
//
// P is taken in low rank: a block Krylov space of L^-1 M from L^-1 F holds the slow responses, and
// in the eigenvectors of L in that space (modes of frequency w_k, damping rate d_k = the diagonal
// of D there) P is known in closed form:
//   P_kl = f_k . f_l (d_k + d_l) / ((w_k^2 - w_l^2)^2 + (d_k + d_l) (d_k w_l^2 + d_l w_k^2)).
// A body without controllers is driven at every node. A very weak spring holds each node, for parts
// that no controller holds.
#ifndef PHYSPRING_TRAINER_REDUCTION_GRAMIAN_H_
#define PHYSPRING_TRAINER_REDUCTION_GRAMIAN_H_

#include "twin/spring_mass_system.h"

namespace physpring {

// One row a node: the squared distance of two rows is D_ij^2. At most `rank` columns.
Eigen::MatrixXd GramianFeatures(const SpringMassSystem& system, int rank);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_REDUCTION_GRAMIAN_H_
