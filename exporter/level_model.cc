// SPDX-License-Identifier: Apache-2.0
#include "exporter/level_model.h"

#include <fmt/format.h>

#include <numeric>

#include "exporter/bodies.h"
#include "exporter/plugin_instance.h"
#include "exporter/tendons.h"
#include "exporter/xml.h"

namespace physpring {
namespace {

void AddHeadComment(const LevelPlan& plan, XmlElement* mujoco) {
  const SpringMassSystem& system = plan.system();
  AddComment(mujoco, fmt::format("Level {} of a twin: {} nodes, {} springs, {} controllers. "
                                 "Written by physpring export " PHYSPRING_VERSION ".",
                                 plan.level, system.node_count(), system.spring_count(),
                                 system.controllers));
  const bool of_springs = plan.critical_timestep <= plan.largest_timestep;
  AddComment(mujoco,
             fmt::format("Largest stable time step of the {}: {:.4g} s. The drag of {:.4g} 1/s is "
                         "joint damping, exact at a time step of {:.4g} s.",
                         of_springs ? "springs" : "controllers on slide joints",
                         plan.StableTimestep(), system.drag, plan.substep));
}

void AddNumbers(const LevelPlan& plan, XmlElement* mujoco) {
  XmlElement* custom = AddElement(mujoco, "custom");
  AddElement(custom, "numeric",
             {{"name", plan.name + "_critical_timestep"}, {"data", Number(plan.StableTimestep())}});
  AddElement(custom, "numeric", {{"name", plan.name + "_substep"}, {"data", Number(plan.substep)}});
}

// Springs that are neither in a flex nor the plugin's.
std::vector<int> SpringsWithTendons(const LevelPlan& plan, const FlexGroups& flexes) {
  if (plan.springs != SpringKind::kTendon) return flexes.tendons;
  std::vector<int> all(plan.system().springs.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

}  // namespace

std::string FormatLevel(const LevelPlan& plan, const FlexGroups& flexes, const Picture& picture) {
  tinyxml2::XMLDocument document;
  XmlElement* mujoco = document.NewElement("mujoco");
  document.InsertEndChild(mujoco);
  mujoco->SetAttribute("model", plan.name.c_str());
  AddHeadComment(plan, mujoco);
  AddNumbers(plan, mujoco);
  AddPluginInstance(plan, mujoco);
  AddDefaults(plan, mujoco);
  XmlElement* worldbody = AddElement(mujoco, "worldbody");
  AddNodes(plan, worldbody);
  AddControllers(plan, worldbody);
  AddFlexes(plan, flexes, mujoco);
  AddTendons(plan, SpringsWithTendons(plan, flexes), mujoco);
  AddAnchors(plan, mujoco);
  AddPicture(plan, picture, mujoco);
  AddActuators(plan, mujoco);
  // without values: the reference configuration, whatever else is in the scene
  AddElement(AddElement(mujoco, "keyframe"), "key", {{"name", plan.name + "_home"}});
  return Print(document);
}

}  // namespace physpring
