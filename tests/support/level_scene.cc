// SPDX-License-Identifier: Apache-2.0
#include "tests/support/level_scene.h"

#include <fmt/format.h>

#include <cmath>

#include "rollout/mujoco_log.h"
#include "twin/attribute_names.h"
#include "twin/cone_name.h"
#include "twin/error.h"
#include "twin/level_numbers.h"

namespace physpring {
namespace {

using Config = std::vector<std::pair<std::string, std::string>>;

std::string Join(const Eigen::VectorXd& values) {
  std::string text;
  for (double value : values) text += fmt::format("{} ", value);
  return text;
}

std::string Vector(const Eigen::Vector3d& v) { return fmt::format("{} {} {}", v[0], v[1], v[2]); }

std::string Geom(const SpringMassSystem& system, int node, const LevelSceneOptions& options) {
  if (!options.contact) return "";
  return fmt::format(R"(<geom size="{}" margin="-0.5" gap="0.6" contype="0"/>)",
                     std::max(system.contact_radius[node], 1e-4));
}

std::string NodeBody(const SpringMassSystem& system, int node, const LevelSceneOptions& options) {
  const double mass = system.mass[node];
  const double damping = mass * std::expm1(options.substep * system.drag) / options.substep;
  std::string joints;
  for (const char* axis : {"1 0 0", "0 1 0", "0 0 1"}) {
    joints += fmt::format(R"(<joint type="slide" axis="{}" damping="{}"/>)", axis, damping);
  }
  return fmt::format(
      R"(<body name="{}_{}" pos="{}" sleep="never"><inertial pos="0 0 0" mass="{}" diaginertia="1 1 1"/>)"
      R"({}<site name="{}_{}"/>{}</body>)",
      options.name, node, Vector(system.position.col(node)), mass, joints, options.name, node,
      Geom(system, node, options));
}

std::string Tendons(const SpringMassSystem& system, const LevelSceneOptions& options) {
  std::string tendons;
  for (int e = 0; e < system.spring_count(); ++e) {
    const auto& [a, b] = system.springs[static_cast<std::size_t>(e)];
    tendons += fmt::format(R"(<spatial stiffness="{}" damping="{}" springlength="{}">)"
                           R"(<site site="{}_{}"/><site site="{}_{}"/></spatial>)",
                           system.stiffness[e], system.dashpot[e], system.rest_length[e],
                           options.name, a, options.name, b);
  }
  return tendons;
}

void Set(const std::string& key, const std::string& value, Config* config) {
  for (auto& [name, text] : *config) {
    if (name != key) continue;
    text = value;
    return;
  }
  config->emplace_back(key, value);
}

Config Attributes(const SpringMassSystem& system, const LevelSceneOptions& options) {
  Config config;
  std::string springs;
  for (const auto& [a, b] : system.springs) springs += fmt::format("{} {} ", a, b);
  if (options.contact) config = {{"springs", springs}};
  if (options.plugin_springs) {
    config = {{"springs", springs},
              {"stiffness", Join(system.stiffness)},
              {"rest_length", Join(system.rest_length)},
              {"dashpot", Join(system.dashpot)},
              {"drag", fmt::to_string(system.drag)},
              {"substep", fmt::to_string(options.substep)},
              {"dashpot_stages", fmt::to_string(system.dashpot_stages)},
              {"controller_velocity", options.controller_velocity ? "1" : "0"}};
  }
  if (options.contact) {
    for (const LevelScalar& number : kLevelScalars) {
      if (number.role == NumberRole::kSprings) continue;
      Set(number.name, fmt::to_string(number.In(system)), &config);
    }
    if (system.contact.surface.cone == FrictionCone::kPyramidal)
      Set(kAttrCone, kPyramidal, &config);
    Set("contact_radius", Join(system.contact_radius), &config);
  }
  for (const auto& [key, value] : options.config) Set(key, value, &config);
  return config;
}

std::string Extension(const SpringMassSystem& system, const LevelSceneOptions& options) {
  std::string config;
  for (const auto& [key, value] : Attributes(system, options)) {
    config += fmt::format(R"(<config key="{}" value="{}"/>)", key, value);
  }
  return fmt::format(
      R"(<extension><plugin plugin="physpring.{}"><instance name="{}">{}</instance></plugin></extension>)",
      options.plugin_springs ? "springs" : "contact", options.name, config);
}

}  // namespace

std::string LevelMjcf(const SpringMassSystem& system, const LevelSceneOptions& options) {
  const bool has_plugin = options.plugin_springs || options.contact;
  const std::string reference =
      has_plugin ? fmt::format(R"(<plugin instance="{}"/>)", options.name) : "";
  std::string nodes, controllers;
  for (int node = 0; node < system.node_count(); ++node) nodes += NodeBody(system, node, options);
  for (int c = system.node_count(); c < system.position.cols(); ++c) {
    controllers +=
        fmt::format(R"(<body name="{}_{}" mocap="true" pos="{}"><site name="{}_{}"/>{}</body>)",
                    options.name, c, Vector(system.position.col(c)), options.name, c,
                    options.plugin_springs ? reference : "");
  }
  return fmt::format(R"(
    <mujoco>
      <option timestep="{}" gravity="{}" {}><flag {}/></option>
      {}
      <worldbody>{}<body name="{}" {}>{}{}</body>{}</worldbody>
      <tendon>{}</tendon>
    </mujoco>)",
                     options.timestep, Vector(options.gravity), options.option, options.flags,
                     has_plugin ? Extension(system, options) : "", options.world, options.name,
                     options.parent_pose, reference, nodes, controllers,
                     options.plugin_springs ? "" : Tendons(system, options));
}

void LoadPlugin() {
  static const bool loaded = [] {
    mj_loadPluginLibrary(PHYSPRING_PLUGIN);
    return true;
  }();
  static_cast<void>(loaded);
}

ModelPtr CompileMjcf(const std::string& mjcf, std::vector<std::string>* warnings) {
  LoadPlugin();
  char message[1024] = "";
  mjSpec* spec = mj_parseXMLString(mjcf.c_str(), nullptr, message, sizeof(message));
  if (!spec) throw Error(OneLine(message));
  mjModel* model = nullptr;
  const std::vector<std::string> said = CatchMujoco([&] { model = mj_compile(spec, nullptr); });
  const std::string error = model ? "" : OneLine(mjs_getError(spec));
  mj_deleteSpec(spec);
  if (warnings != nullptr) warnings->insert(warnings->end(), said.begin(), said.end());
  if (!model) throw Error(error);
  ModelPtr owner(model);
  if (warnings == nullptr && !said.empty()) throw Error(said.front());
  return owner;
}

LevelScene::LevelScene(const SpringMassSystem& system, const LevelSceneOptions& options)
    : nodes_(system.node_count()),
      reference_(system.position.leftCols(nodes_)),
      model_(CompileMjcf(LevelMjcf(system, options))),
      data_(MakeData(*model_)) {
  mj_forward(model_.get(), data_.get());
}

void LevelScene::SetState(const Points& position, const Points& velocity) {
  Eigen::Map<Points>(data_->qpos, 3, nodes_) = position - reference_;
  Eigen::Map<Points>(data_->qvel, 3, nodes_) = velocity;
}

void LevelScene::SetControllers(const Points& position) {
  Eigen::Map<Points>(data_->mocap_pos, 3, position.cols()) = position;
}

void LevelScene::Step(int count) {
  for (int i = 0; i < count; ++i) physpring::Step(*model_, data_.get());
}

Points LevelScene::Positions() const {
  return reference_ + Eigen::Map<const Points>(data_->qpos, 3, nodes_);
}

Points LevelScene::Velocities() const { return Eigen::Map<const Points>(data_->qvel, 3, nodes_); }

}  // namespace physpring
