// SPDX-License-Identifier: Apache-2.0
#include "plugin/level.h"

#include <fmt/format.h>

#include <algorithm>

#include "twin/attribute_names.h"
#include "twin/cone_name.h"
#include "twin/effects/effect_json.h"
#include "twin/effects/registry.h"
#include "twin/error.h"
#include "twin/level_numbers.h"
#include "twin/quote.h"

namespace physpring {
namespace {

std::string BodyName(const mjModel* model, int body) {
  const char* name = mj_id2name(model, mjOBJ_BODY, body);
  return name != nullptr && *name != '\0' ? fmt::format("body {}", Quote(name))
                                          : fmt::format("body {}", body);
}

bool IsFixed(const mjModel* model, int body) { return model->body_weldid[body] == 0; }

// Where a body is at qpos0.
Eigen::Vector3d Position(const mjModel* model, int body) {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  for (; body != 0; body = model->body_parentid[body]) {
    mju_rotVecQuat(position.data(), Eigen::Vector3d(position).data(), model->body_quat + 4 * body);
    position += Eigen::Map<const Eigen::Vector3d>(model->body_pos + 3 * body);
  }
  return position;
}

// The mass of each body with those that are fixed in it, kg.
std::vector<double> WeldedMass(const mjModel* model) {
  std::vector<double> mass(model->nbody, 0);
  for (int body = 1; body < model->nbody; ++body) {
    mass[model->body_weldid[body]] += model->body_mass[body];
  }
  return mass;
}

// Three slide joints along orthogonal axes.
bool MovesFreely(const mjModel* model, int body) {
  if (model->body_jntnum[body] != 3) return false;
  const int joint = model->body_jntadr[body];
  for (int j = 0; j < 3; ++j) {
    if (model->jnt_type[joint + j] != mjJNT_SLIDE) return false;
  }
  const Eigen::Map<const Eigen::Matrix3d> axes(model->jnt_axis + 3 * joint);
  return (axes.transpose() * axes).isIdentity(1e-9);
}

void CheckNode(const mjModel* model, int body, const std::string& where) {
  const auto fail = [&](const std::string& problem) {
    throw Error(fmt::format("{}: {} {}", where, BodyName(model, body), problem));
  };
  if (!MovesFreely(model, body)) fail("is a node, expected three orthogonal slide joints");
  const int dof = model->body_dofadr[body];
  for (int j = 0; j < 3; ++j) {
    const double armature = model->dof_armature[dof + j];
    if (armature != 0) fail(fmt::format("has joint armature {}, expected 0", armature));
    const double friction = model->dof_frictionloss[dof + j];
    if (friction != 0) fail(fmt::format("has joint frictionloss {}, expected 0", friction));
    const int joint = model->body_jntadr[body] + j;
    const double stiffness = model->jnt_stiffness[joint];
    if (stiffness != 0) fail(fmt::format("has joint stiffness {}, expected 0", stiffness));
    if (model->jnt_limited[joint]) fail("has joints with a range, expected none");
  }
}

void CheckParent(const mjModel* model, int instance, const LevelBodies& bodies,
                 const std::string& where) {
  if (bodies.parent == 0) {
    throw Error(
        fmt::format("{}: no body that is fixed in the world refers to it, expected the "
                    "nodes' parent",
                    where));
  }
  for (int body = bodies.parent + 1; body < model->nbody; ++body) {
    if (model->body_plugin[body] != instance || !IsFixed(model, body)) continue;
    throw Error(
        fmt::format("{}: {} and {} are both fixed in the world, expected one parent of the "
                    "nodes",
                    where, BodyName(model, bodies.parent), BodyName(model, body)));
  }
  if (bodies.nodes.empty()) {
    throw Error(fmt::format("{}: {} has no child bodies with joints, expected the nodes", where,
                            BodyName(model, bodies.parent)));
  }
}

void CheckCount(const Attributes& attributes, const char* name, std::size_t found) {
  const double given = attributes.Number(name, static_cast<double>(found));
  if (given == static_cast<double>(found)) return;
  throw Error(fmt::format("{}: attribute '{}' is {}, but the model has {}", attributes.where(),
                          name, given, found));
}

void ReadContact(const Attributes& attributes, Level* level) {
  SpringMassSystem& system = level->system;
  for (const LevelScalar& number : kLevelScalars) {
    if (number.role == NumberRole::kSprings) continue;
    if (number.role == NumberRole::kSurface) level->has_surface |= attributes.Has(number.name);
    number.In(system) = attributes.Number(number.name, number.In(system));
  }
  system.contact.surface.cone = ConeOf(attributes.Word(kAttrCone, {kElliptic, kPyramidal}));
  level->has_contact_radius = attributes.Has("contact_radius");
  system.contact_radius.setZero(system.node_count());
  if (level->has_contact_radius) {
    system.contact_radius = attributes.Each("contact_radius", system.node_count());
  }
}

RodEdges ReadRodEdges(const Attributes& attributes, Eigen::Index columns) {
  try {
    return EdgesOfEnds(attributes.Integers(kAttrRod), columns);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: attribute 'rod' {}", attributes.where(), error.what()));
  }
}

void ReadEffects(const Attributes& attributes, SpringMassSystem* system) {
  if (attributes.Has(kAttrOrder)) {
    system->rod = PlainRod(attributes.Each(kAttrOrder, system->position.cols()));
  }
  if (attributes.Has(kAttrRod)) {
    system->rod.edges = ReadRodEdges(attributes, system->rod.arc.size());
  }
  if (attributes.Has(kAttrEffects)) {
    system->effects = EffectsFromJson(attributes.Text(kAttrEffects),
                                      attributes.where() + ": attribute 'effects'");
  }
}

// What changes masses, rest lengths, gravity, contacts or the controllers' motion belongs there.
void CheckEffects(const Attributes& attributes, const SpringMassSystem& system) {
  for (const EffectValues& effect : system.effects) {
    if (GetEffect(effect.name).HasForces(system, effect.values)) continue;
    throw Error(fmt::format("{}: attribute 'effects' has {}, expected effects that exert forces",
                            attributes.where(), Quote(effect.name)));
  }
}

}  // namespace

std::vector<const char*> WithLevelNumbers(std::vector<const char*> names,
                                          const std::vector<NumberRole>& roles) {
  const auto add = [&](const auto& number) {
    if (std::find(roles.begin(), roles.end(), number.role) == roles.end()) return;
    names.push_back(number.name);
  };
  for (const LevelList& list : kLevelLists) add(list);
  for (const LevelScalar& number : kLevelScalars) add(number);
  return names;
}

LevelBodies FindBodies(const mjModel* model, int instance) {
  LevelBodies bodies;
  for (int body = 1; body < model->nbody; ++body) {
    if (model->body_plugin[body] == instance) {
      if (!IsFixed(model, body)) {
        bodies.controllers.push_back(body);
      } else if (bodies.parent == 0) {
        bodies.parent = body;
      }
    } else if (bodies.parent != 0 && model->body_parentid[body] == bodies.parent &&
               model->body_jntnum[body] > 0) {
      bodies.nodes.push_back(body);
    }
  }
  return bodies;
}

Level ReadLevel(const mjModel* model, int instance, const Attributes& attributes) {
  const std::string& where = attributes.where();
  Level level;
  level.bodies = FindBodies(model, instance);
  CheckParent(model, instance, level.bodies, where);
  const std::vector<int>& nodes = level.bodies.nodes;
  CheckCount(attributes, kAttrNodes, nodes.size());

  SpringMassSystem& system = level.system;
  system.controllers = static_cast<int>(level.bodies.controllers.size());
  system.position.setZero(3, static_cast<Eigen::Index>(nodes.size()) + system.controllers);
  system.mass.resize(static_cast<Eigen::Index>(nodes.size()));
  const std::vector<double> mass = WeldedMass(model);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    CheckNode(model, nodes[i], where);
    const Eigen::Index column = static_cast<Eigen::Index>(i);
    system.position.col(column) = Position(model, nodes[i]);
    system.mass[column] = mass[nodes[i]];
    level.dofs.push_back(model->body_dofadr[nodes[i]]);
    level.joints.push_back(model->body_jntadr[nodes[i]]);
  }
  for (int c = 0; c < system.controllers; ++c) {
    system.position.col(system.node_count() + c) = Position(model, level.bodies.controllers[c]);
  }
  ReadContact(attributes, &level);
  system.Validate(where);
  return level;
}

void CheckOptions(const mjModel* model, const Level& level, const std::string& where) {
  const int integrator = model->opt.integrator;
  if (integrator == mjINT_RK4 || integrator == mjINT_DISCRETE) {
    throw Error(fmt::format("{}: option integrator is {}, expected Euler, implicit or implicitfast",
                            where, integrator == mjINT_RK4 ? "RK4" : "discrete"));
  }
  if ((model->opt.enableflags & mjENBL_SLEEP) == 0) return;
  for (int node : level.bodies.nodes) {
    if (model->tree_sleep_policy[model->body_treeid[node]] == mjSLEEP_NEVER) continue;
    throw Error(
        fmt::format("{}: {} may fall asleep while springs pull it, expected sleep=\"never\"", where,
                    BodyName(model, node)));
  }
}

void CheckStateSize(const mjModel* model, int instance, int size, const std::string& where) {
  if (model->plugin_statenum[instance] == size) return;
  throw Error(fmt::format("{}: the model was compiled with {} numbers of state, expected {}", where,
                          model->plugin_statenum[instance], size));
}

void ReadJoinedPairs(const Attributes& attributes, Level* level) {
  SpringMassSystem& system = level->system;
  const std::vector<int> ends = attributes.Integers(kAttrSprings);
  if (ends.size() % 2 != 0) {
    throw Error(fmt::format("{}: attribute 'springs' has {} numbers, expected two for each spring",
                            attributes.where(), ends.size()));
  }
  for (std::size_t e = 0; e < ends.size(); e += 2) system.springs.push_back({ends[e], ends[e + 1]});
  const int count = system.spring_count();
  system.stiffness.setZero(count);
  system.rest_length.setOnes(count);
  system.dashpot.setZero(count);
  system.Validate(attributes.where());
}

void ReadSprings(const Attributes& attributes, Level* level) {
  CheckCount(attributes, kAttrControllers, level->bodies.controllers.size());
  if (!attributes.Has(kAttrSprings)) {
    throw Error(fmt::format("{}: attribute 'springs' is missing, expected two numbers for each",
                            attributes.where()));
  }
  ReadJoinedPairs(attributes, level);
  SpringMassSystem& system = level->system;
  for (const LevelList& list : kLevelLists) {
    if (list.role != NumberRole::kSprings) continue;
    list.In(system) = attributes.Each(list.name, list.SizeIn(system));
  }
  for (const LevelScalar& number : kLevelScalars) {
    if (number.role != NumberRole::kSprings) continue;
    number.In(system) = attributes.Number(number.name, number.In(system));
  }
  ReadEffects(attributes, &system);
  system.Validate(attributes.where());
  CheckEffects(attributes, system);
}

}  // namespace physpring
