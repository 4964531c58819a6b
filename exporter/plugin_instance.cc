// SPDX-License-Identifier: Apache-2.0
#include "exporter/plugin_instance.h"

#include <algorithm>
#include <string>
#include <vector>

#include "twin/cone_name.h"
#include "twin/effects/effect_json.h"

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

void AddSpringKeys(const LevelPlan& plan, XmlElement* instance) {
  const SpringMassSystem& system = plan.system();
  AddConfig(instance, "nodes", std::to_string(system.node_count()));
  AddConfig(instance, "controllers", std::to_string(system.controllers));
  AddConfig(instance, "springs", SpringEnds(system, false));
  AddConfig(instance, "stiffness", Compact(system.stiffness));
  AddConfig(instance, "rest_length", Compact(system.rest_length));
  AddConfig(instance, "dashpot", Compact(system.dashpot));
  AddConfig(instance, "drag", Number(system.drag));
  AddConfig(instance, "substep", Number(plan.substep));
  if (!plan.plugin_effects.empty()) {
    AddConfig(instance, "effects", EffectsToJson(plan.plugin_effects));
  }
  if (system.order.size() > 0) AddConfig(instance, "order", Numbers(system.order));
  AddConfig(instance, "controller_velocity", plan.twin->controller_velocity ? "1" : "0");
}

void AddContactKeys(const LevelPlan& plan, XmlElement* instance) {
  const ContactCoefficients& contact = plan.system().contact;
  AddConfig(instance, "restitution", Number(contact.restitution));
  AddConfig(instance, "friction", Number(contact.friction));
  AddConfig(instance, "object_restitution", Number(contact.object_restitution));
  AddConfig(instance, "object_friction", Number(contact.object_friction));
  if (contact.cone == FrictionCone::kPyramidal) AddConfig(instance, "cone", kPyramidal);
  AddConfig(instance, "collision_distance", Number(contact.collision_distance));
  AddConfig(instance, "contact_radius", Compact(plan.system().contact_radius));
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
    AddConfig(instance, "springs", SpringEnds(plan.system(), true));
  }
  if (plan.contact == ContactKind::kPlugin) AddContactKeys(plan, instance);
}

}  // namespace physpring
