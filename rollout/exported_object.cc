// SPDX-License-Identifier: Apache-2.0
#include "rollout/exported_object.h"

#include <fmt/format.h>

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

}  // namespace physpring
