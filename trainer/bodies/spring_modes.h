// SPDX-License-Identifier: Apache-2.0
// Smooth fields over the springs of a body: the lowest modes of its spring graph.
#ifndef PHYSPRING_TRAINER_BODIES_SPRING_MODES_H_
#define PHYSPRING_TRAINER_BODIES_SPRING_MODES_H_

#include "twin/spring_mass_system.h"

namespace physpring {

struct FieldModes {
  Eigen::MatrixXd fields;     // springs x modes
  Eigen::VectorXd roughness;  // of each mode: its eigenvalue over the first one's
};

// At most `count` modes: the eigenvectors with the lowest eigenvalues above 0 of the graph
// Laplacian of all nodes and controllers, whose links weigh 1 / L^2. A spring has the mean of its
// two ends. The root mean square of each mode is 1, and its first entry above a tenth of that is
// positive.
FieldModes SpringModes(const SpringMassSystem& system, int count);

// Fields that rise evenly along the body's one to three long directions: those of the principal
// axes of the springs' middles along which they spread by a fifth of the widest. The root mean
// square of each is 1, its mean 0. A thin plate bends in none of them (Wahba, Spline Models for
// Observational Data, 1990, ch. 2), where the modes above all end flat.
Eigen::MatrixXd EvenSlopes(const SpringMassSystem& system);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_BODIES_SPRING_MODES_H_
