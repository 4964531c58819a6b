// SPDX-License-Identifier: Apache-2.0
// One level of a twin: an explicit spring-mass system (design: physics).
//
// Free nodes come first, kinematic controllers after them. Spring e = (a, b) pulls a towards b with
//   F = k (|d| - L) + c ((v_b - v_a) . n),   d = x_b - x_a,   n = d / |d|.
#ifndef PHYSPRING_TWIN_SPRING_MASS_SYSTEM_H_
#define PHYSPRING_TWIN_SPRING_MASS_SYSTEM_H_

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "twin/contact_law.h"
#include "twin/effects/effect_values.h"
#include "twin/points.h"
#include "twin/rod.h"

namespace physpring {

// Coefficients of the impulse contact law (see contact_law.h).
struct ContactCoefficients {
  ContactPair<double> surface = {0.5, 0.3};  // against ground and geoms
  ContactPair<double> object = {0.7, 0.3};   // between particles; their cone is elliptic
  double collision_distance = 0;             // m, between particles; 0 = particles do not collide

  bool operator==(const ContactCoefficients&) const = default;
};

struct SpringMassSystem {
  Points position;       // 3 x (nodes + controllers), m: reference configuration
  int controllers = 0;   // the last columns of `position`
  Eigen::VectorXd mass;  // (nodes), kg, > 0

  std::vector<std::array<int, 2>> springs;  // (a, b), columns of `position`
  Eigen::VectorXd stiffness;                // (springs), N/m, >= 0
  Eigen::VectorXd rest_length;              // (springs), m, > 0
  Eigen::VectorXd dashpot;                  // (springs), N s/m, >= 0
  double drag = 0;                          // 1/s, >= 0: v <- v exp(-h drag)
  // Into how many stages a sub-step takes the dashpots (dashpot_stages.h), >= 1. A training takes
  // as many as cost least, up to this.
  int dashpot_stages = 1;

  Rod rod;  // of nodes and controllers; empty if the body is no rod
  // Physics besides that of springs, drag and contact; they act in this order.
  std::vector<EffectValues> effects;

  ContactCoefficients contact;
  Eigen::VectorXd contact_radius;  // (nodes), m: distance from a surface at which a node touches it

  // Of systems with as many nodes, controllers and springs.
  bool operator==(const SpringMassSystem&) const = default;

  int node_count() const { return static_cast<int>(position.cols()) - controllers; }
  int spring_count() const { return static_cast<int>(springs.size()); }
  // Whether a spring has a controller at one end.
  bool IsControllerSpring(int e) const {
    return std::max(springs[e][0], springs[e][1]) >= node_count();
  }

  // Controllers (0, 1, ...) that no spring joins to a node: they move nothing.
  std::vector<int> UnjoinedControllers() const;

  // Throws Error, one line that begins with `where`, unless all shapes agree, all numbers are
  // finite and in range, effects are known, and no spring joins a node to itself, a pair twice, or
  // two controllers.
  void Validate(const std::string& where) const;
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_SPRING_MASS_SYSTEM_H_
