// SPDX-License-Identifier: Apache-2.0
#include "tests/support/tendon_oracle.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <stdexcept>
#include <vector>

#include "rollout/mujoco_log.h"
#include "twin/effects/registry.h"

namespace physpring {
namespace {

ModelPtr Compile(const std::string& mjcf) {
  char message[1024] = "";
  mjSpec* spec = mj_parseXMLString(mjcf.c_str(), nullptr, message, sizeof(message));
  if (!spec) throw std::runtime_error(message);
  mjModel* model = nullptr;
  const std::vector<std::string> warnings = CatchMujoco([&] { model = mj_compile(spec, nullptr); });
  const std::string error = model ? "" : mjs_getError(spec);
  mj_deleteSpec(spec);
  if (!model) throw std::runtime_error(error);
  ModelPtr owner(model);
  if (!warnings.empty()) throw std::runtime_error(warnings.front());
  return owner;
}

std::string NodeBody(const SpringMassSystem& system, int node, double timestep) {
  const Eigen::Vector3d position = system.position.col(node);
  const double mass = system.mass[node];
  const double damping = mass * std::expm1(timestep * system.drag) / timestep;
  std::string joints;
  for (const char* axis : {"1 0 0", "0 1 0", "0 0 1"}) {
    joints += fmt::format(R"(<joint type="slide" axis="{}" damping="{}"/>)", axis, damping);
  }
  return fmt::format(R"(<body pos="{} {} {}"><inertial pos="0 0 0" mass="{}" diaginertia="1 1 1"/>)"
                     R"({}<site name="{}"/></body>)",
                     position[0], position[1], position[2], mass, joints, node);
}

std::string ControllerBody(const SpringMassSystem& system, int column) {
  const Eigen::Vector3d position = system.position.col(column);
  return fmt::format(R"(<body mocap="true" pos="{} {} {}"><site name="{}"/></body>)", position[0],
                     position[1], position[2], column);
}

// Of each spring's tendon. Effects add attributes or replace them.
std::vector<std::map<std::string, std::string>> TendonAttributes(const SpringMassSystem& system) {
  std::vector<std::map<std::string, std::string>> attributes;
  for (int e = 0; e < system.spring_count(); ++e) {
    attributes.push_back({{"stiffness", fmt::format("{}", system.stiffness[e])},
                          {"damping", fmt::format("{}", system.dashpot[e])},
                          {"springlength", fmt::format("{}", system.rest_length[e])}});
  }
  for (const EffectValues& effect : system.effects) {
    const EffectMjcf mjcf = GetEffect(effect.name).Mjcf(effect.values, system);
    for (std::size_t e = 0; e < attributes.size(); ++e) {
      for (const auto& [name, value] : mjcf.tendon.at(e)) attributes[e][name] = value;
    }
  }
  return attributes;
}

}  // namespace

std::string TendonMjcf(const SpringMassSystem& system, const Eigen::Vector3d& gravity,
                       double timestep) {
  std::string bodies, tendons;
  for (int node = 0; node < system.node_count(); ++node) bodies += NodeBody(system, node, timestep);
  for (int controller = 0; controller < system.controllers; ++controller) {
    bodies += ControllerBody(system, system.node_count() + controller);
  }
  const auto attributes = TendonAttributes(system);
  for (std::size_t e = 0; e < attributes.size(); ++e) {
    tendons += "<spatial";
    for (const auto& [name, value] : attributes[e]) {
      tendons += fmt::format(R"( {}="{}")", name, value);
    }
    const auto& [a, b] = system.springs[e];
    tendons += fmt::format(R"(><site site="{}"/><site site="{}"/></spatial>)", a, b);
  }
  return fmt::format(R"(
    <mujoco>
      <option integrator="Euler" timestep="{}" gravity="{} {} {}"><flag contact="disable"/></option>
      <worldbody>{}</worldbody>
      <tendon>{}</tendon>
    </mujoco>)",
                     timestep, gravity[0], gravity[1], gravity[2], bodies, tendons);
}

TendonOracle::TendonOracle(const SpringMassSystem& system, const Eigen::Vector3d& gravity,
                           double timestep)
    : reference_(system.position.leftCols(system.node_count())),
      model_(Compile(TendonMjcf(system, gravity, timestep))),
      data_(MakeData(*model_)) {}

void TendonOracle::SetState(const Points& position, const Points& velocity) {
  Eigen::Map<Points>(data_->qpos, 3, reference_.cols()) = position - reference_;
  Eigen::Map<Points>(data_->qvel, 3, reference_.cols()) = velocity;
}

void TendonOracle::Step(const Points& controllers) {
  Eigen::Map<Points>(data_->mocap_pos, 3, controllers.cols()) = controllers;
  physpring::Step(*model_, data_.get());
}

Points TendonOracle::Positions() const {
  return reference_ + Eigen::Map<const Points>(data_->qpos, 3, reference_.cols());
}

Points TendonOracle::Velocities() const {
  return Eigen::Map<const Points>(data_->qvel, 3, reference_.cols());
}

}  // namespace physpring
