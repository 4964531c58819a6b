// SPDX-License-Identifier: Apache-2.0
// Everything learnable of a system by name, for Python: "stiffness", "friction", "air_drag" ...
#ifndef PHYSPRING_PYTHON_BINDINGS_PARAMETERS_H_
#define PHYSPRING_PYTHON_BINDINGS_PARAMETERS_H_

#include <string>
#include <vector>

#include "twin/environment.h"
#include "twin/spring_mass_system.h"
#include "twin/system_gradient.h"

namespace physpring {

struct NamedNumbers {
  std::string name;
  double* numbers;
  std::size_t size;
  bool scalar;
};

// (springs): stiffness, rest_length, dashpot; (nodes): mass; drag; gravity (3); the coefficients of
// contact; the values of each effect under its name ("NAME#2" for a second one).
std::vector<NamedNumbers> ParametersOf(SpringMassSystem* system, Environment* environment);

// The derivatives, in the same order. `system`: what they are of.
std::vector<NamedNumbers> GradientsOf(const SpringMassSystem& system, SystemGradient* gradient);

}  // namespace physpring

#endif  // PHYSPRING_PYTHON_BINDINGS_PARAMETERS_H_
