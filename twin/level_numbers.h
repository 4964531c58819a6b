// SPDX-License-Identifier: Apache-2.0
// The numbers of a level, listed once: names, units, ranges and where they stand. The twin file,
// the checks of SpringMassSystem, the plugin's attributes and the exporter go through these lists,
// so a new number is a member of SpringMassSystem (with its default) and a line here. Those of
// contact come from kContactCoefficients (contact_law.h). Counts, springs' ends, effects and the
// cone of friction are no numbers.
#ifndef PHYSPRING_TWIN_LEVEL_NUMBERS_H_
#define PHYSPRING_TWIN_LEVEL_NUMBERS_H_

#include <array>
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
  // Where it stands: in the system itself, in its contact, or in one kind of contact.
  double SpringMassSystem::*of_system = nullptr;
  double ContactCoefficients::*of_contact = nullptr;
  ContactPair<double> ContactCoefficients::*kind = nullptr;
  double ContactPair<double>::*of_kind = nullptr;

  const double& In(const SpringMassSystem& system) const {
    if (of_system) return system.*of_system;
    return of_contact ? system.contact.*of_contact : system.contact.*kind.*of_kind;
  }
  double& In(SpringMassSystem& system) const {
    if (of_system) return system.*of_system;
    return of_contact ? system.contact.*of_contact : system.contact.*kind.*of_kind;
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

constexpr auto MakeLevelScalars() {
  std::array<LevelScalar, 2 + 2 * kContactCount> scalars{};
  auto next = scalars.begin();
  *next++ = {.name = "drag",
             .unit = "1/s",
             .role = NumberRole::kSprings,
             .most = kAnyNumber,
             .of_system = &SpringMassSystem::drag};
  for (const auto& c : kContactCoefficients<double>) {
    *next++ = {.name = c.name,
               .unit = "",
               .role = NumberRole::kSurface,
               .most = c.most,
               .kind = &ContactCoefficients::surface,
               .of_kind = c.member};
  }
  for (const auto& c : kContactCoefficients<double>) {
    *next++ = {.name = c.object_name,
               .unit = "",
               .role = NumberRole::kObject,
               .most = c.most,
               .kind = &ContactCoefficients::object,
               .of_kind = c.member};
  }
  *next = {.name = "collision_distance",
           .unit = "m",
           .role = NumberRole::kReach,
           .most = kAnyNumber,
           .of_contact = &ContactCoefficients::collision_distance};
  return scalars;
}

inline constexpr auto kLevelScalars = MakeLevelScalars();

inline constexpr LevelList kLevelLists[] = {
    {"mass", "kg", NumberRole::kBody, false, kMoreThanZero, &SpringMassSystem::mass},
    {"contact_radius", "m", NumberRole::kReach, false, 0, &SpringMassSystem::contact_radius},
    {"stiffness", "N/m", NumberRole::kSprings, true, 0, &SpringMassSystem::stiffness},
    {"rest_length", "m", NumberRole::kSprings, true, kMoreThanZero, &SpringMassSystem::rest_length},
    {"dashpot", "N s/m", NumberRole::kSprings, true, 0, &SpringMassSystem::dashpot},
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_LEVEL_NUMBERS_H_
