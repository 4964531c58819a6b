// SPDX-License-Identifier: Apache-2.0
#include "plugin/force.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <exception>

#include "plugin/contact.h"
#include "plugin/instance.h"
#include "plugin/springs.h"
#include "twin/attribute_names.h"
#include "twin/error.h"
#include "twin/quote.h"

namespace physpring {
namespace {

using Vector = Eigen::Vector3d;
using Rows = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;

bool IsTwin(const mjModel* model, int instance) {
  return IsOf<Springs>(model, instance) || IsOf<LevelContact>(model, instance);
}

// The twin's instance of which a body is the nodes' parent; -1 = none.
int LevelOfParent(const mjModel* model, int body) {
  const int instance = model->body_plugin[body];
  if (instance < 0 || model->body_weldid[body] != 0 || !IsTwin(model, instance)) return -1;
  return FindBodies(model, instance).parent == body ? instance : -1;
}

// Whether `part` is `body`, or fixed in it.
bool IsPartOf(const mjModel* model, int part, int body) {
  while (part > body && model->body_weldid[part] == model->body_weldid[body]) {
    part = model->body_parentid[part];
  }
  return part == body;
}

std::vector<int> PartsOf(const mjModel* model, int body) {
  std::vector<int> parts;
  for (int part = body; part < model->nbody; ++part) {
    if (IsPartOf(model, part, body)) parts.push_back(part);
  }
  return parts;
}

// The instance of the twin that each body is a node of; -1: none.
std::vector<int> LevelsOfBodies(const mjModel* model, const std::string& where) {
  std::vector<int> level(model->nbody, -1);
  bool has_twin = false;
  for (int instance = 0; instance < model->nplugin; ++instance) {
    if (!IsTwin(model, instance)) continue;
    has_twin = true;
    for (int node : FindBodies(model, instance).nodes) level[node] = instance;
  }
  if (!has_twin) {
    throw Error(fmt::format("{}: the model has no twin, expected one with {} or {}", where,
                            Springs::kName, LevelContact::kName));
  }
  for (int body = 1; body < model->nbody; ++body) level[body] = level[model->body_weldid[body]];
  return level;
}

// 0 where it is not given.
int NodeCount(const mjModel* model, const Attributes& attributes) {
  if (!attributes.Has(kAttrNodes)) return 0;
  const std::vector<int> count = attributes.Integers(kAttrNodes);
  if (count.size() == 1 && count[0] > 0 && count[0] < model->nbody) return count[0];
  throw Error(fmt::format("{}: attribute 'nodes' is {}, expected how many nodes the level has",
                          attributes.where(), Quote(attributes.Text(kAttrNodes))));
}

std::string NameOf(const mjModel* model, mjtObj type, int id) {
  const char* name = mj_id2name(model, type, id);
  return name != nullptr && *name != '\0' ? Quote(name) : fmt::format("{}", id);
}

}  // namespace

const std::vector<const char*>& ForceSensor::AttributeNames() {
  static const std::vector<const char*> names = {kAttrNodes};
  return names;
}

ForceSensor::ForceSensor(const mjModel* model, int instance)
    : level_of_body_(LevelsOfBodies(model, Attributes(model, instance).where())),
      wrench_(6, model->nbody) {
  const Attributes attributes(model, instance);
  for (int sensor = 0; sensor < model->nsensor; ++sensor) {
    if (model->sensor_type[sensor] != mjSENS_PLUGIN) continue;
    if (model->sensor_plugin[sensor] != instance) continue;
    const std::string where =
        fmt::format("{}: sensor {}", attributes.where(), NameOf(model, mjOBJ_SENSOR, sensor));
    sensors_.push_back(ReadSensor(model, sensor, NodeCount(model, attributes), where));
  }
}

int ForceSensor::SensorSize(const mjModel* model, int instance, int) {
  try {
    const int nodes = NodeCount(model, Attributes(model, instance));
    return nodes > 0 ? 3 * nodes : 6;
  } catch (const std::exception&) {
    return 6;  // refused, with a message, when an instance is made
  }
}

ForceSensor::Sensor ForceSensor::ReadSensor(const mjModel* model, int sensor, int nodes,
                                            const std::string& where) {
  const int type = model->sensor_objtype[sensor], id = model->sensor_objid[sensor];
  const int address = model->sensor_adr[sensor];
  if ((type != mjOBJ_BODY && type != mjOBJ_SITE) || id < 0) {
    throw Error(where + " has another objtype, expected body or site");
  }
  if (model->sensor_reftype[sensor] != mjOBJ_UNKNOWN) {
    throw Error(where + " has a reference, expected none");
  }
  if (type == mjOBJ_BODY && (nodes > 0 || LevelOfParent(model, id) >= 0)) {
    return {address, true, -1, ReadNodes(model, id, nodes, where)};
  }
  if (nodes > 0) throw Error(where + " is of a site, expected no attribute 'nodes'");
  const int site = type == mjOBJ_SITE ? id : -1;
  return {address, false, site, {PartsOf(model, site < 0 ? id : model->site_bodyid[site])}};
}

std::vector<ForceSensor::Parts> ForceSensor::ReadNodes(const mjModel* model, int body, int count,
                                                       const std::string& where) {
  const std::string name = NameOf(model, mjOBJ_BODY, body);
  const int level = LevelOfParent(model, body);
  if (level < 0) {
    throw Error(fmt::format("{}: body {} is no parent of nodes, expected no attribute 'nodes'",
                            where, name));
  }
  const std::vector<int> nodes = FindBodies(model, level).nodes;
  if (count != static_cast<int>(nodes.size())) {
    throw Error(
        fmt::format("{}: body {} is the parent of {} nodes, expected the attribute 'nodes' "
                    "with that number",
                    where, name, nodes.size()));
  }
  std::vector<Parts> parts;
  for (int node : nodes) parts.push_back(PartsOf(model, node));
  return parts;
}

void ForceSensor::Compute(const mjModel* model, mjData* data, int) {
  wrench_.setZero();
  constexpr int kNoPassive = mjDSBL_SPRING | mjDSBL_DAMPER;
  if ((model->opt.disableflags & kNoPassive) != kNoPassive) AddImpulses(model, data);
  wrench_ /= model->opt.timestep;
  AddContacts(model, data);
  for (const Sensor& sensor : sensors_) Write(sensor, data);
}

void ForceSensor::AddImpulses(const mjModel* model, const mjData* data) {
  for (int instance = 0; instance < model->nplugin; ++instance) {
    if (data->plugin_data[instance] == 0) continue;
    if (IsOf<LevelContact>(model, instance)) {
      AddTouches(data, InstanceOf<LevelContact>(data, instance)->surfaces());
    } else if (IsOf<Springs>(model, instance)) {
      const Springs& springs = *InstanceOf<Springs>(data, instance);
      AddTouches(data, springs.surfaces());
      springs.ForEachPull([&](int controller, const Vector& impulse) {
        AddAt(data, data->xpos + 3 * controller, impulse, controller);
      });
    }
  }
}

void ForceSensor::AddTouches(const mjData* data, const Surfaces& surfaces) {
  surfaces.ForEachImpulse([&](int node, int body, const Vector6& impulse) {
    wrench_.col(body) += impulse;
    AddAt(data, data->xpos + 3 * node, -impulse.tail<3>(), node);
  });
}

void ForceSensor::AddContacts(const mjModel* model, const mjData* data) {
  for (int i = 0; i < data->ncon; ++i) {
    const mjContact& contact = data->contact[i];
    if (contact.efc_address < 0 || contact.geom[0] < 0 || contact.geom[1] < 0) continue;
    const int first = model->geom_bodyid[contact.geom[0]];
    const int second = model->geom_bodyid[contact.geom[1]];
    if (level_of_body_[first] == level_of_body_[second]) continue;  // or both are of no twin
    Vector6 force;  // of the first on the second, in the contact's axes, then its torque
    mj_contactForce(model, data, i, force.data());
    const Rows axes(contact.frame);
    const Vector in_world = axes.transpose() * force.head<3>();
    const Vector torque = axes.transpose() * force.tail<3>();
    AddAt(data, contact.pos, in_world, second);
    AddAt(data, contact.pos, -in_world, first);
    wrench_.col(second).head<3>() += torque;
    wrench_.col(first).head<3>() -= torque;
  }
}

void ForceSensor::AddAt(const mjData* data, const double* point, const Vector& force, int body) {
  const Vector arm =
      Eigen::Map<const Vector>(point) - Eigen::Map<const Vector>(data->xipos + 3 * body);
  wrench_.col(body).head<3>() += arm.cross(force);
  wrench_.col(body).tail<3>() += force;
}

ForceSensor::Vector6 ForceSensor::Sum(const mjData* data, const Parts& parts,
                                      const double* point) const {
  Vector6 sum = Vector6::Zero();
  for (int body : parts) {
    const Vector arm =
        Eigen::Map<const Vector>(data->xipos + 3 * body) - Eigen::Map<const Vector>(point);
    sum += wrench_.col(body);
    sum.head<3>() += arm.cross(Vector(wrench_.col(body).tail<3>()));
  }
  return sum;
}

void ForceSensor::Write(const Sensor& sensor, mjData* data) const {
  double* out = data->sensordata + sensor.address;
  if (sensor.is_of_nodes) {
    for (const Parts& node : sensor.parts) {
      const Vector force = Sum(data, node, data->xipos + 3 * node[0]).tail<3>();
      out = std::copy_n(force.data(), 3, out);
    }
    return;
  }
  const Parts& body = sensor.parts[0];
  if (sensor.site < 0) {
    const Vector6 wrench = Sum(data, body, data->xipos + 3 * body[0]);
    Eigen::Map<Vector6>(out) << wrench.tail<3>(), wrench.head<3>();
  } else {
    const Rows axes(data->site_xmat + 9 * sensor.site);
    const Vector6 wrench = Sum(data, body, data->site_xpos + 3 * sensor.site);
    Eigen::Map<Vector6>(out) << axes.transpose() * wrench.tail<3>(),
        axes.transpose() * wrench.head<3>();
  }
}

}  // namespace physpring
