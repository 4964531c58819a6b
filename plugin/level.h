// SPDX-License-Identifier: Apache-2.0
// One level of a twin as a MuJoCo model holds it. A plugin instance is referred to by
//   one body that is fixed in the world, the parent: its child bodies that have joints are the
//     nodes, in document order, each with three orthogonal slide joints;
//   any number of other bodies: the controllers, in document order, mocap bodies or moving ones.
// No names are involved, so that <attach> may add a prefix.
#ifndef PHYSPRING_PLUGIN_LEVEL_H_
#define PHYSPRING_PLUGIN_LEVEL_H_

#include <mujoco/mujoco.h>

#include <optional>
#include <string>
#include <vector>

#include "plugin/attributes.h"
#include "twin/level_numbers.h"
#include "twin/spring_mass_system.h"

namespace physpring {

// `names` and those of the level's numbers of these roles: the attributes of a plugin.
std::vector<const char*> WithLevelNumbers(std::vector<const char*> names,
                                          const std::vector<NumberRole>& roles);

struct LevelBodies {
  int parent = 0;
  std::vector<int> nodes, controllers;
};

// The bodies that refer to a plugin instance. Does not check that there are any.
LevelBodies FindBodies(const mjModel* model, int instance);

struct Level {
  LevelBodies bodies;
  std::vector<int> dofs;            // (nodes) the first of a node's three
  std::vector<int> joints;          // (nodes) the first of a node's three
  SpringMassSystem system;          // positions at qpos0, in the world
  bool has_surface = false;         // the contact law acts between nodes and geoms
  bool has_contact_radius = false;  // false: nodes touch where their geoms do
};

// Reads what springs and contacts have in common: masses from the bodies, contact coefficients from
// the attributes. Throws Error, one line that names the instance and body or attribute and value.
Level ReadLevel(const mjModel* model, int instance, const Attributes& attributes);

// Throws Error where the model's options keep the plugins from working: integrator, sleep. Apart
// from ReadLevel, because the compiler counts a plugin's state before it decides about sleep.
void CheckOptions(const mjModel* model, const Level& level, const std::string& where);

// Throws Error if the model was compiled with another size of plugin_state: by another library.
void CheckStateSize(const mjModel* model, int instance, int size, const std::string& where);

// Reads which nodes springs join into `level`, as springs that do nothing: such nodes never
// collide.
void ReadJoinedPairs(const Attributes& attributes, Level* level);

// Reads springs, their parameters, drag and effects into `level`.
void ReadSprings(const Attributes& attributes, Level* level);

}  // namespace physpring

#endif  // PHYSPRING_PLUGIN_LEVEL_H_
