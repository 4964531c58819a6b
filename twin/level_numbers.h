// SPDX-License-Identifier: Apache-2.0
// The numbers of a level, listed once: names, units, ranges and where they stand. The twin file,
// the checks of SpringMassSystem, the plugin's attributes and the exporter go through these lists,
// so a new coefficient is a member of SpringMassSystem or ContactCoefficients (with its default)
// and a line here. Counts, springs' ends, effects and the cone of friction are no numbers.
#ifndef PHYSPRING_TWIN_LEVEL_NUMBERS_H_
#define PHYSPRING_TWIN_LEVEL_NUMBERS_H_

#include <limits>

#include "twin/spring_mass_system.h"

namespace physpring {

// What a number belongs to.
enum class NumberRole {
  kBody,     // what the nodes are; in MJCF, bodies have it
  kSprings,  // springs, dashpots and drag
  kSurface,  // the contact law against ground and geoms
  kObject,   // the contact law between particles
  kReach,    // from where on contacts act
};

// A number that a level has one of. Its least value is 0.
struct LevelScalar {
  const char* name;  // in twin files, MJCF and messages
  const char* unit;  // "" for a ratio
  NumberRole role;
  double most;
  double ContactCoefficients::*of_contact;  // null for one of the system's own
  double SpringMassSystem::*of_system = nullptr;

  double& In(SpringMassSystem& system) const {
    return of_system ? system.*of_system : system.contact.*of_contact;
  }
  double In(const SpringMassSystem& system) const {
    return of_system ? system.*of_system : system.contact.*of_contact;
  }
};

// A number that a level has one of for each node or each spring.
struct LevelList {
  const char* name;
  const char* unit;
  NumberRole role;
  bool of_springs;  // false: of nodes
  double least;
  Eigen::VectorXd SpringMassSystem::*of_system;

  Eigen::VectorXd& In(SpringMassSystem& system) const { return system.*of_system; }
  const Eigen::VectorXd& In(const SpringMassSystem& system) const { return system.*of_system; }

  Eigen::Index SizeIn(const SpringMassSystem& system) const {
    return of_springs ? system.spring_count() : system.node_count();
  }
};

inline constexpr double kAnyNumber = std::numeric_limits<double>::infinity();
inline constexpr double kMoreThanZero = std::numeric_limits<double>::min();

inline constexpr LevelScalar kLevelScalars[] = {
    {"drag", "1/s", NumberRole::kSprings, kAnyNumber, nullptr, &SpringMassSystem::drag},
    {"restitution", "", NumberRole::kSurface, 1, &ContactCoefficients::restitution},
    {"friction", "", NumberRole::kSurface, 2, &ContactCoefficients::friction},
    {"object_restitution", "", NumberRole::kObject, 1, &ContactCoefficients::object_restitution},
    {"object_friction", "", NumberRole::kObject, 2, &ContactCoefficients::object_friction},
    {"collision_distance", "m", NumberRole::kReach, kAnyNumber,
     &ContactCoefficients::collision_distance},
};

inline constexpr LevelList kLevelLists[] = {
    {"mass", "kg", NumberRole::kBody, false, kMoreThanZero, &SpringMassSystem::mass},
    {"contact_radius", "m", NumberRole::kReach, false, 0, &SpringMassSystem::contact_radius},
    {"stiffness", "N/m", NumberRole::kSprings, true, 0, &SpringMassSystem::stiffness},
    {"rest_length", "m", NumberRole::kSprings, true, kMoreThanZero, &SpringMassSystem::rest_length},
    {"dashpot", "N s/m", NumberRole::kSprings, true, 0, &SpringMassSystem::dashpot},
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_LEVEL_NUMBERS_H_
