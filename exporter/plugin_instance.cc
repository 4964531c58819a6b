// SPDX-License-Identifier: Apache-2.0
#include "exporter/plugin_instance.h"

#include <algorithm>
#include <string>
#include <vector>

#include "twin/attribute_names.h"
#include "twin/cone_name.h"
#include "twin/effects/effect_json.h"
#include "twin/level_numbers.h"

namespace physpring {
namespace {

void AddConfig(XmlElement* instance, const char* key, const std::string& value) {
  AddElement(instance, "config", {{"key", key}, {"value", value}});
}

// One value where all are equal.
std::string Compact(const Eigen::VectorXd& values) {
  const bool equal = values.size() > 0 && (values.array() == values[0]).all();
  return equal ? Number(values[0]) : Numbers(values);
}

// The ends of each spring; of those between nodes only, if `nodes_only`.
std::string SpringEnds(const SpringMassSystem& system, bool nodes_only) {
  std::vector<int> ends;
  for (const auto& [a, b] : system.springs) {
    if (nodes_only && std::max(a, b) >= system.node_count()) continue;
    ends.insert(ends.end(), {a, b});
  }
  return Numbers(ends);
}

void AddScalars(const SpringMassSystem& system, NumberRole role, XmlElement* instance) {
  for (const LevelScalar& number : kLevelScalars) {
    if (number.role == role) AddConfig(instance, number.name, Number(number.In(system)));
  }
}

void AddLists(const SpringMassSystem& system, NumberRole role, XmlElement* instance) {
  for (const LevelList& list : kLevelLists) {
    if (list.role == role) AddConfig(instance, list.name, Compact(list.In(system)));
  }
}

// Edges only where not all columns follow each other by their arc lengths.
void AddRodKeys(const Rod& rod, XmlElement* instance) {
  AddConfig(instance, kAttrOrder, Numbers(rod.arc));
  if (rod.edges == PlainRod(rod.arc).edges) return;
  std::vector<int> ends;
  for (const auto& [a, b] : rod.edges) ends.insert(ends.end(), {a, b});
  AddConfig(instance, kAttrRod, Numbers(ends));
}

void AddSpringKeys(const LevelPlan& plan, XmlElement* instance) {
  const SpringMassSystem& system = plan.system();
  AddConfig(instance, kAttrNodes, std::to_string(system.node_count()));
  AddConfig(instance, kAttrControllers, std::to_string(system.controllers));
  AddConfig(instance, kAttrSprings, SpringEnds(system, false));
  AddLists(system, NumberRole::kSprings, instance);
  AddScalars(system, NumberRole::kSprings, instance);
  AddConfig(instance, kAttrSubstep, Number(plan.substep));
  if (system.dashpot_stages > 1) {
    AddConfig(instance, kAttrDashpotStages, std::to_string(system.dashpot_stages));
  }
  if (!plan.plugin_effects.empty()) {
    AddConfig(instance, kAttrEffects, EffectsToJson(plan.plugin_effects));
  }
  if (!system.rod.empty()) AddRodKeys(system.rod, instance);
  AddConfig(instance, kAttrControllerVelocity, plan.twin->controller_velocity ? "1" : "0");
  const ControllerMask& late = plan.twin->late;
  if (!late.empty()) {
    AddConfig(instance, kAttrReleased, Numbers(std::vector<int>(late.begin(), late.end())));
  }
}

void AddContactKeys(const LevelPlan& plan, XmlElement* instance) {
  const SpringMassSystem& system = plan.system();
  AddScalars(system, NumberRole::kSurface, instance);
  AddScalars(system, NumberRole::kObject, instance);
  if (system.contact.surface.cone == FrictionCone::kPyramidal)
    AddConfig(instance, kAttrCone, kPyramidal);
  AddScalars(system, NumberRole::kReach, instance);
  AddLists(system, NumberRole::kReach, instance);
}

}  // namespace

void AddPluginInstance(const LevelPlan& plan, XmlElement* mujoco) {
  if (!plan.NeedsPlugin()) return;
  const bool springs = plan.springs == SpringKind::kPlugin;
  XmlElement* plugin =
      AddElement(AddElement(mujoco, "extension"), "plugin",
                 {{"plugin", springs ? "physpring.springs" : "physpring.contact"}});
  XmlElement* instance = AddElement(plugin, "instance", {{"name", plan.name}});
  if (springs) {
    AddSpringKeys(plan, instance);
  } else if (plan.system().contact.collision_distance > 0) {
    // particles that a spring joins never collide
    AddConfig(instance, kAttrSprings, SpringEnds(plan.system(), true));
  }
  if (plan.contact == ContactKind::kPlugin) AddContactKeys(plan, instance);
}

}  // namespace physpring
