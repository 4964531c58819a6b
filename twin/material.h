// SPDX-License-Identifier: Apache-2.0
// What a twin's level 0 is made of, as far as the recordings told that it was fitted to.
#ifndef PHYSPRING_TWIN_MATERIAL_H_
#define PHYSPRING_TWIN_MATERIAL_H_

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <vector>

#include "twin/json_fields.h"

namespace physpring {

// A positive quantity that was estimated, and the interval that holds the true one in 90 % of all
// cases, if the model is right but for noise.
struct Estimate {
  double value = 0, low = 0, high = 0;

  // Whether the recordings tell it to a factor of 2.
  bool IsTold() const { return low > 0.5 * value && high < 2 * value; }
};

struct Material {
  // Springs between particles whose lengths are about alike.
  struct LengthClass {
    double shortest, longest;  // m
    int springs;
    Estimate axial_stiffness;  // N: the mean of stiffness times length
  };
  // A particle about which springs are softer or stiffer than springs of their lengths elsewhere.
  struct Place {
    Eigen::Vector3d position;  // m, in frame 0
    Estimate factor;           // of the stiffness
  };

  std::vector<LengthClass> classes;
  Estimate loss_time;  // s: dashpot / stiffness, of all springs between particles
  Estimate drag;       // 1/s
  Place softest, stiffest;
};

nlohmann::ordered_json MaterialToJson(const Material& material);

// Throws Error for an object that is not of MaterialToJson's form.
Material MaterialFromJson(const JsonFields& fields);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_MATERIAL_H_
