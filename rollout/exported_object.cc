// SPDX-License-Identifier: Apache-2.0
#include "rollout/exported_object.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <string_view>

#include "rollout/scene.h"
#include "twin/attribute_names.h"
#include "twin/error.h"

namespace physpring {
namespace {

using Vector = Eigen::Map<Eigen::Vector3d>;
using ConstVector = Eigen::Map<const Eigen::Vector3d>;
using Axes = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;

// The names of all objects: a level has a number NAME_substep.
std::vector<std::string> ObjectNames(const mjModel& model) {
  constexpr std::string_view kNumber = "_substep";
  std::vector<std::string> names;
  for (int i = 0; i < model.nnumeric; ++i) {
    const std::string_view name = model.names + model.name_numericadr[i];
    if (name.size() > kNumber.size() && name.substr(name.size() - kNumber.size()) == kNumber) {
      names.emplace_back(name.substr(0, name.size() - kNumber.size()));
    }
  }
  return names;
}

// FORMAT_0, FORMAT_1, ... as far as there are.
std::vector<int> Bodies(const mjModel& model, const std::string& stem) {
  std::vector<int> bodies;
  for (;;) {
    const std::string name = fmt::format("{}_{}", stem, bodies.size());
    const int body = mj_name2id(&model, mjOBJ_BODY, name.c_str());
    if (body < 0) return bodies;
    bodies.push_back(body);
  }
}

// That of physpring.springs which a controller belongs to, or -1.
int SpringsInstance(const mjModel& model, int controller) {
  const int instance = model.body_plugin[controller];
  if (instance < 0) return -1;
  const mjpPlugin* plugin = mjp_getPluginAtSlot(model.plugin[instance]);
  return plugin != nullptr && std::string_view(plugin->name) == "physpring.springs" ? instance : -1;
}

}  // namespace

ExportedObject::ExportedObject(const mjModel& model, const std::string& where) : model_(model) {
  const std::vector<std::string> names = ObjectNames(model);
  if (names.size() != 1) {
    throw Error(fmt::format("{}: holds {} objects written by physpring export, expected 1", where,
                            names.size()));
  }
  nodes_ = Bodies(model, names[0]);
  for (const int node : nodes_) {
    if (model.body_jntnum[node] == 3) continue;
    throw Error(fmt::format("{}: body {} is not on three slide joints", where,
                            model.names + model.name_bodyadr[node]));
  }
  controllers_ = Bodies(model, names[0] + "_controller");
  if (!controllers_.empty()) instance_ = SpringsInstance(model, controllers_[0]);
  grasp_springs_ = GraspSprings();
  for (std::size_t c = 0; c < controllers_.size(); ++c) {
    if (model.body_mocapid[controllers_[c]] >= 0) continue;
    const std::string actuator = fmt::format("{}_controller_{}_x", names[0], c);
    actuators_.push_back(mj_name2id(&model, mjOBJ_ACTUATOR, actuator.c_str()));
    if (actuators_.back() >= 0) continue;
    throw Error(fmt::format("{}: has no actuator {}", where, actuator));
  }
}

void ExportedObject::PlaceBody(const Eigen::Vector3d& position, const Eigen::Vector3d& velocity,
                               int body, mjData* data) const {
  const int parent = model_.body_parentid[body], joint = model_.body_jntadr[body];
  const Axes axes(data->xmat + 9 * parent);
  Vector(data->qpos + model_.jnt_qposadr[joint]) =
      axes.transpose() * (position - ConstVector(data->xpos + 3 * parent)) -
      ConstVector(model_.body_pos + 3 * body);
  Vector(data->qvel + model_.jnt_dofadr[joint]) = axes.transpose() * velocity;
}

void ExportedObject::SetNodes(const Points& position, const Points& velocity, mjData* data) const {
  for (int i = 0; i < node_count(); ++i) {
    PlaceBody(position.col(i), velocity.col(i), nodes_[i], data);
  }
}

Points ExportedObject::Nodes(const mjData& data) const {
  Points position(3, node_count());
  for (int i = 0; i < node_count(); ++i) position.col(i) = ConstVector(data.xpos + 3 * nodes_[i]);
  return position;
}

void ExportedObject::SetControllers(const Points& position, const Points& velocity,
                                    mjData* data) const {
  auto actuator = actuators_.begin();
  for (int c = 0; c < controller_count(); ++c) {
    const int body = controllers_[c], mocap = model_.body_mocapid[body];
    if (mocap >= 0) {
      Vector(data->mocap_pos + 3 * mocap) = position.col(c);
      continue;
    }
    PlaceBody(position.col(c), velocity.col(c), body, data);
    // the actuators hold it there
    Vector(data->ctrl + *actuator++) =
        Vector(data->qpos + model_.jnt_qposadr[model_.body_jntadr[body]]);
  }
}

std::optional<PluginState> ExportedObject::StateOf(mjData* data) const {
  if (instance_ < 0) return {};
  return PluginState(data->plugin_state + model_.plugin_stateadr[instance_], node_count(),
                     controller_count());
}

void ExportedObject::StartControllers(const Points& position, mjData* data) const {
  const auto state = StateOf(data);
  if (!state) return;
  Eigen::Map<Points>(state->controllers, 3, controller_count()) = position;
  *state->known = 1;
}

std::vector<ExportedObject::GraspSpring> ExportedObject::GraspSprings() const {
  std::vector<GraspSpring> springs;
  if (instance_ < 0) return springs;
  const DataPtr data = MakeData(model_);
  mj_kinematics(&model_, data.get());
  std::istringstream ends(mj_getPluginConfig(&model_, instance_, kAttrSprings));
  for (int a = 0, b = 0; ends >> a >> b;) {
    const auto [node, other] = std::minmax(a, b);
    const int controller = other - node_count();
    if (controller < 0) continue;
    const Eigen::Vector3d arm = ConstVector(data->xpos + 3 * controllers_[controller]) -
                                ConstVector(data->xpos + 3 * nodes_[node]);
    springs.push_back({node, controller, arm.norm()});
  }
  return springs;
}

void ExportedObject::SetGrasps(const ControllerMask& released, const Attachment& taken,
                               mjData* data) const {
  const auto state = StateOf(data);
  if (!state)
    throw Error("has springs of MuJoCo's own, which never let go: export it with --springs plugin");
  for (int c = 0; c < controller_count(); ++c) {
    state->released[c] = Has(released, c) ? 1 : 0;
    if (Has(taken.attached, c)) state->were_released[c] = 0;  // what it holds is said here
  }
  const std::size_t records = (grasp_springs_.size() + kRecordSize - 1) / kRecordSize;
  double* shift = data->plugin_state + model_.plugin_stateadr[instance_] +
                  model_.plugin_statenum[instance_] - kRecordSize * records;
  for (const auto& [node, controller, reference] : grasp_springs_) {
    if (Has(taken.attached, controller)) {
      *shift = (taken.controllers.col(controller) - taken.nodes.col(node)).norm() - reference;
    }
    ++shift;
  }
}

}  // namespace physpring
