// SPDX-License-Identifier: Apache-2.0
#include "plugin/level.h"

#include <fmt/format.h>

#include <cmath>

#include "twin/error.h"
#include "twin/quote.h"

namespace physpring {
namespace {

std::string BodyName(const mjModel* model, int body) {
  const char* name = mj_id2name(model, mjOBJ_BODY, body);
  return name != nullptr && *name != '\0' ? fmt::format("body {}", Quote(name))
                                          : fmt::format("body {}", body);
}

bool IsFixed(const mjModel* model, int body) { return model->body_weldid[body] == 0; }

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
  }
  if ((model->opt.enableflags & mjENBL_SLEEP) != 0 &&
      model->tree_sleep_policy[model->body_treeid[body]] != mjSLEEP_NEVER) {
    fail("may fall asleep while springs pull it, expected sleep=\"never\"");
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

void CheckIntegrator(const mjModel* model, const std::string& where) {
  const int integrator = model->opt.integrator;
  if (integrator == mjINT_EULER || integrator == mjINT_IMPLICIT ||
      integrator == mjINT_IMPLICITFAST) {
    return;
  }
  throw Error(fmt::format("{}: option integrator is {}, expected Euler, implicit or implicitfast",
                          where, integrator == mjINT_RK4 ? "RK4" : "discrete"));
}

void CheckCount(const Attributes& attributes, const char* name, std::size_t found) {
  const double given = attributes.Number(name, static_cast<double>(found));
  if (given == static_cast<double>(found)) return;
  throw Error(fmt::format("{}: attribute '{}' is {}, but the model has {}", attributes.where(),
                          name, given, found));
}

void ReadContact(const Attributes& attributes, Level* level) {
  SpringMassSystem& system = level->system;
  ContactCoefficients& contact = system.contact;
  level->has_surface = attributes.Has("restitution") || attributes.Has("friction");
  contact.restitution = attributes.Number("restitution", contact.restitution);
  contact.friction = attributes.Number("friction", contact.friction);
  contact.object_restitution = attributes.Number("object_restitution", contact.object_restitution);
  contact.object_friction = attributes.Number("object_friction", contact.object_friction);
  contact.collision_distance = attributes.Number("collision_distance", contact.collision_distance);
  level->has_contact_radius = attributes.Has("contact_radius");
  system.contact_radius.setZero(system.node_count());
  if (level->has_contact_radius) {
    system.contact_radius = attributes.Each("contact_radius", system.node_count());
  }
}

}  // namespace

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
  CheckIntegrator(model, where);
  Level level;
  level.bodies = FindBodies(model, instance);
  CheckParent(model, instance, level.bodies, where);
  const std::vector<int>& nodes = level.bodies.nodes;
  CheckCount(attributes, "nodes", nodes.size());

  SpringMassSystem& system = level.system;
  system.controllers = static_cast<int>(level.bodies.controllers.size());
  system.position.setZero(3, static_cast<Eigen::Index>(nodes.size()) + system.controllers);
  system.mass.resize(static_cast<Eigen::Index>(nodes.size()));
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    CheckNode(model, nodes[i], where);
    const Eigen::Index column = static_cast<Eigen::Index>(i);
    system.position.col(column) = Eigen::Map<const Eigen::Vector3d>(model->body_pos + 3 * nodes[i]);
    system.mass[column] = model->body_subtreemass[nodes[i]];
    level.dofs.push_back(model->body_dofadr[nodes[i]]);
    level.joints.push_back(model->body_jntadr[nodes[i]]);
  }
  ReadContact(attributes, &level);
  system.Validate(where);
  return level;
}

void ReadJoinedPairs(const Attributes& attributes, Level* level) {
  SpringMassSystem& system = level->system;
  const std::vector<int> ends = attributes.Integers("springs");
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
  CheckCount(attributes, "controllers", level->bodies.controllers.size());
  if (!attributes.Has("springs")) {
    throw Error(fmt::format("{}: attribute 'springs' is missing, expected two numbers for each",
                            attributes.where()));
  }
  ReadJoinedPairs(attributes, level);
  SpringMassSystem& system = level->system;
  const int count = system.spring_count();
  system.stiffness = attributes.Each("stiffness", count);
  system.rest_length = attributes.Each("rest_length", count);
  system.dashpot = attributes.Each("dashpot", count);
  system.drag = attributes.Number("drag", 0);
  system.Validate(attributes.where());
}

}  // namespace physpring
