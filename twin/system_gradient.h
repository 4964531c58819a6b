// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TWIN_SYSTEM_GRADIENT_H_
#define PHYSPRING_TWIN_SYSTEM_GRADIENT_H_

#include <vector>

#include "twin/contact.h"
#include "twin/spring_mass_system.h"

namespace physpring {

// Derivatives of a loss with respect to everything learnable. Shapes as in SpringMassSystem.
struct SystemGradient {
  Eigen::VectorXd stiffness, rest_length, dashpot;  // (springs)
  Eigen::VectorXd mass;                             // (nodes)
  double drag = 0;
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();
  ContactLaws<double> contact;           // with respect to the coefficients
  std::vector<Eigen::VectorXd> effects;  // for each effect, with respect to its values

  explicit SystemGradient(const SpringMassSystem& system);
  SystemGradient& operator+=(const SystemGradient& other);
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_SYSTEM_GRADIENT_H_
