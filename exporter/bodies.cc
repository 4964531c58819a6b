// SPDX-License-Identifier: Apache-2.0
#include "exporter/bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace physpring {
namespace {

constexpr double kLeastRadius = 1e-4;  // m, of a geom
// The ratio of a controller's mass to the object's. Springs push it aside by h^2 F / m in a step.
constexpr double kControllerMass = 10;
const char* const kAxes[] = {"1 0 0", "0 1 0", "0 0 1"};

const char* const kAxisNames[] = {"x", "y", "z"};
// With the plugin: MuJoCo's own contact only starts at this depth, and geoms are found this far
// away, m.
constexpr double kDepth = 0.015, kDetection = 0.01;
constexpr double kTendonWidth = 5e-4;  // m, in pictures
constexpr double kLeastDampingRatio = 0.05;

bool AllEqual(const Eigen::VectorXd& values) {
  return values.size() == 0 || (values.array() == values[0]).all();
}

double Radius(const SpringMassSystem& system, int node) {
  return std::max(system.contact_radius[node], kLeastRadius);
}

// The radius of sites and controllers in pictures, m.
double DrawnRadius(const Twin& twin) { return 0.25 * twin.levels[0].system.rest_length.mean(); }

double Damping(const LevelPlan& plan, int node) {
  const double h = plan.substep;
  return plan.system().mass[node] * std::expm1(h * plan.system().drag) / h;
}

double ControllerMass(const LevelPlan& plan) { return kControllerMass * plan.system().mass.sum(); }

// Damping ratio of a spring and dashpot from which a body bounces with restitution e.
double DampingRatio(double restitution) {
  if (restitution <= 0) return 1;
  const double decay = -std::log(restitution);
  return decay / std::hypot(decay, std::numbers::pi);
}

// What joints of nodes and controllers are, whatever the defaults of a scene that includes the
// level say.
XmlElement* AddSlideDefaults(XmlElement* parent) {
  return AddElement(parent, "joint",
                    {{"type", "slide"},
                     {"limited", "false"},
                     {"stiffness", "0"},
                     {"armature", "0"},
                     {"frictionloss", "0"}});
}

// Nodes do not collide with each other, nor with nodes of other twins; everything else with them.
// Their friction counts, whatever that of the other geom.
void AddNodeGeomDefaults(const LevelPlan& plan, XmlElement* node_class) {
  const SpringMassSystem& system = plan.system();
  XmlElement* geom = AddElement(node_class, "geom",
                                {{"type", "sphere"},
                                 {"condim", "3"},
                                 {"margin", "0"},
                                 {"gap", "0"},
                                 {"solimp", "0.9 0.95 0.001 0.5 2"},
                                 {"size", Number(Radius(system, 0))},
                                 {"contype", "0"},
                                 {"priority", "1"},
                                 {"friction", Number(system.contact.surface.friction) + " 0 0"},
                                 {"group", "3"}});
  if (plan.contact == ContactKind::kPlugin) {
    // found by MuJoCo and left to the plugin
    geom->SetAttribute("margin", Number(-kDepth).c_str());
    geom->SetAttribute("gap", Number(kDepth + kDetection).c_str());
  } else {
    const double ratio =
        std::max(DampingRatio(system.contact.surface.restitution), kLeastDampingRatio);
    geom->SetAttribute("solref", (Number(4 * plan.timestep) + " " + Number(ratio)).c_str());
  }
}

void AddNode(const LevelPlan& plan, int node, XmlElement* parent) {
  const SpringMassSystem& system = plan.system();
  XmlElement* body = AddElement(
      parent, "body", {{"name", plan.Body(node)}, {"pos", Numbers(system.position.col(node))}});
  // the plugin acts in every step
  if (plan.NeedsPlugin()) body->SetAttribute("sleep", "never");
  const double mass = system.mass[node];
  const double inertia = 0.4 * mass * std::pow(Radius(system, node), 2);
  AddElement(body, "inertial",
             {{"pos", "0 0 0"},
              {"mass", Number(mass)},
              {"diaginertia", Numbers(Eigen::Vector3d::Constant(inertia))}});
  for (const char* axis : kAxes) {
    XmlElement* joint = AddElement(body, "joint", {{"axis", axis}});
    if (!AllEqual(system.mass)) joint->SetAttribute("damping", Number(Damping(plan, node)).c_str());
  }
  AddElement(body, "site", {{"name", plan.Body(node)}});
  if (plan.springs == SpringKind::kFlex) AddElement(body, "body", {{"name", plan.Vertex(node)}});
  if (plan.contact == ContactKind::kNone) return;
  XmlElement* geom = AddElement(body, "geom");
  if (!AllEqual(system.contact_radius)) {
    geom->SetAttribute("size", Number(Radius(system, node)).c_str());
  }
}

void AddController(const LevelPlan& plan, int controller, XmlElement* worldbody) {
  const int column = plan.system().node_count() + controller;
  const std::string name = plan.Body(column);
  XmlElement* body = AddElement(worldbody, "body", {{"name", name}});
  body->SetAttribute("childclass", plan.ControllerClass().c_str());
  body->SetAttribute("pos", Numbers(plan.system().position.col(column)).c_str());
  if (plan.controllers == ControllerKind::kMocap) {
    body->SetAttribute("mocap", "true");
  } else {
    body->SetAttribute("gravcomp", "1");
    AddElement(body, "inertial",
               {{"pos", "0 0 0"},
                {"mass", Number(ControllerMass(plan))},
                {"diaginertia", Numbers(Eigen::Vector3d::Constant(ControllerMass(plan)))}});
    for (int axis = 0; axis < 3; ++axis) {
      AddElement(body, "joint",
                 {{"name", fmt::format("{}_{}", name, kAxisNames[axis])}, {"axis", kAxes[axis]}});
    }
  }
  AddElement(body, "site", {{"name", name}});
  AddElement(body, "geom");
  if (plan.springs == SpringKind::kPlugin) {
    AddElement(body, "plugin", {{"instance", plan.name}});
  }
}

}  // namespace

void AddDefaults(const LevelPlan& plan, XmlElement* mujoco) {
  const SpringMassSystem& system = plan.system();
  const std::string size = Number(DrawnRadius(*plan.twin));
  XmlElement* top = AddElement(AddElement(mujoco, "default"), "default", {{"class", plan.name}});
  AddElement(top, "site", {{"size", size}, {"group", "4"}});
  AddElement(top, "tendon",
             {{"width", Number(kTendonWidth)},
              {"group", "4"},
              {"limited", "false"},
              {"frictionloss", "0"}});

  XmlElement* node = AddElement(top, "default", {{"class", plan.NodeClass()}});
  XmlElement* joint = AddSlideDefaults(node);
  if (AllEqual(system.mass)) joint->SetAttribute("damping", Number(Damping(plan, 0)).c_str());
  if (plan.contact != ContactKind::kNone) AddNodeGeomDefaults(plan, node);

  if (system.controllers == 0) return;
  XmlElement* controller = AddElement(top, "default", {{"class", plan.ControllerClass()}});
  AddSlideDefaults(controller)->SetAttribute("damping", "0");
  AddElement(controller, "geom",
             {{"type", "sphere"},
              {"size", size},
              {"contype", "0"},
              {"conaffinity", "0"},
              {"rgba", "0.8 0.3 0.2 1"}});
  if (plan.controllers == ControllerKind::kMocap) return;
  const double gain = ControllerMass(plan) / plan.timestep;
  AddElement(controller, "position", {{"kp", Number(gain / plan.timestep)}, {"kv", Number(gain)}});
}

void AddNodes(const LevelPlan& plan, XmlElement* worldbody) {
  XmlElement* parent = AddElement(worldbody, "body", {{"name", plan.name}});
  parent->SetAttribute("childclass", plan.NodeClass().c_str());
  if (plan.NeedsPlugin()) AddElement(parent, "plugin", {{"instance", plan.name}});
  for (int node = 0; node < plan.system().node_count(); ++node) AddNode(plan, node, parent);
}

void AddControllers(const LevelPlan& plan, XmlElement* worldbody) {
  for (int i = 0; i < plan.system().controllers; ++i) AddController(plan, i, worldbody);
}

void AddActuators(const LevelPlan& plan, XmlElement* mujoco) {
  if (plan.controllers == ControllerKind::kMocap || plan.system().controllers == 0) return;
  XmlElement* actuator = AddElement(mujoco, "actuator");
  for (int i = 0; i < plan.system().controllers; ++i) {
    for (const char* axis : kAxisNames) {
      const std::string name =
          fmt::format("{}_{}", plan.Body(plan.system().node_count() + i), axis);
      AddElement(actuator, "position",
                 {{"name", name}, {"class", plan.ControllerClass()}, {"joint", name}});
    }
  }
}

}  // namespace physpring
