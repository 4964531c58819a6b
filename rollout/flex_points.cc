// SPDX-License-Identifier: Apache-2.0
#include "rollout/flex_points.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <set>

#include "twin/error.h"

namespace physpring {
namespace {

std::string BodyName(const mjModel& model, int body) {
  const char* name = mj_id2name(&model, mjOBJ_BODY, body);
  return name ? fmt::format("'{}'", name) : fmt::format("number {}", body);
}

// Whether `body` is a mocap body or rigidly on one.
bool OnMocap(const mjModel& model, int body) {
  return model.body_mocapid[model.body_weldid[body]] >= 0;
}

// Whether nothing but the scene's author moves `body`.
bool Kinematic(const mjModel& model, int body) {
  return OnMocap(model, body) || model.body_weldid[body] == 0;
}

// Bodies that are tied to each body by active <connect> and <weld> equalities.
std::vector<std::vector<int>> TiedBodies(const mjModel& model) {
  std::vector<std::vector<int>> tied(static_cast<std::size_t>(model.nbody));
  for (int i = 0; i < model.neq; ++i) {
    if (!model.eq_active0[i]) continue;
    if (model.eq_type[i] != mjEQ_CONNECT && model.eq_type[i] != mjEQ_WELD) continue;
    int a = model.eq_obj1id[i], b = model.eq_obj2id[i];
    if (model.eq_objtype[i] == mjOBJ_SITE) {
      a = model.site_bodyid[a];
      b = model.site_bodyid[b];
    }
    tied[static_cast<std::size_t>(a)].push_back(b);
    tied[static_cast<std::size_t>(b)].push_back(a);
  }
  return tied;
}

// Vertices on the surface, for each vertex of the flex.
std::vector<bool> SurfaceVertices(const mjModel& model) {
  const bool solid = model.flex_dim[0] == 3;
  std::vector<bool> surface(static_cast<std::size_t>(model.flex_vertnum[0]), !solid);
  if (!solid) return surface;
  const int* corner = model.flex_shell + model.flex_shelldataadr[0];
  for (int i = 0; i < 3 * model.flex_shellnum[0]; ++i) {
    surface[static_cast<std::size_t>(corner[i])] = true;
  }
  return surface;
}

void CheckFlex(const mjModel& model, const std::string& where) {
  if (model.nflex != 1) {
    throw Error(
        fmt::format("{}: has {} flexes; a recording is of exactly one", where, model.nflex));
  }
  if (model.flex_interp[0] != 0) {
    throw Error(where + ": the flex's vertices are interpolated; dof=\"full\" makes them bodies");
  }
}

// The body must not be moved by a mocap body and by its own joints.
void CheckNotCarried(const mjModel& model, int body, const std::string& where) {
  for (int b = model.body_parentid[body]; b > 0; b = model.body_parentid[b]) {
    if (model.body_mocapid[b] < 0) continue;
    throw Error(fmt::format(
        "{}: flex body {} is a jointed child of mocap body {}, which would carry it along; put "
        "the flex outside and tie the held vertices by <equality><connect>",
        where, BodyName(model, body), BodyName(model, b)));
  }
}

}  // namespace

FlexPoints FindFlexPoints(const mjModel& model, const std::string& where) {
  CheckFlex(model, where);
  const std::vector<std::vector<int>> tied = TiedBodies(model);
  const std::vector<bool> surface = SurfaceVertices(model);
  FlexPoints result;
  std::set<int> bodies;  // that carry vertices and have a mass of their own
  bool held_by_mocap = false;
  for (int vertex = 0; vertex < model.flex_vertnum[0]; ++vertex) {
    const int body = model.flex_vertbodyid[vertex];
    std::vector<int> holders = tied[static_cast<std::size_t>(body)];
    holders.push_back(body);
    const auto kinematic = [&](int b) { return Kinematic(model, b); };
    const auto on_mocap = [&](int b) { return OnMocap(model, b); };
    const bool held = std::any_of(holders.begin(), holders.end(), kinematic);
    held_by_mocap |= std::any_of(holders.begin(), holders.end(), on_mocap);
    if (!Kinematic(model, body)) {
      CheckNotCarried(model, body, where);
      bodies.insert(body);
    }
    (held                                        ? result.controllers
     : surface[static_cast<std::size_t>(vertex)] ? result.points
                                                 : result.interior)
        .push_back(vertex);
  }
  if (result.points.empty()) throw Error(where + ": the flex is rigid: all its vertices are held");
  if (!held_by_mocap) {
    throw Error(where +
                ": no mocap body holds the flex; tie vertices to one by <equality><connect>");
  }
  for (const int body : bodies) result.mass += model.body_mass[body];
  return result;
}

Points VertexPositions(const mjData& data, const std::vector<int>& vertices) {
  Points positions(3, static_cast<Eigen::Index>(vertices.size()));
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    positions.col(static_cast<Eigen::Index>(i)) =
        Eigen::Map<const Eigen::Vector3d>(data.flexvert_xpos + 3 * vertices[i]);
  }
  return positions;
}

Points VertexVelocities(const mjModel& model, const mjData& data,
                        const std::vector<int>& vertices) {
  Points velocities(3, static_cast<Eigen::Index>(vertices.size()));
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const int body = model.flex_vertbodyid[vertices[i]];
    Eigen::Matrix<double, 6, 1> motion;  // of the body frame: angular, linear; world axes
    mj_objectVelocity(&model, &data, mjOBJ_XBODY, body, motion.data(), 0);
    const Eigen::Vector3d angular = motion.head<3>(), linear = motion.tail<3>();
    const Eigen::Vector3d arm =
        Eigen::Map<const Eigen::Vector3d>(data.flexvert_xpos + 3 * vertices[i]) -
        Eigen::Map<const Eigen::Vector3d>(data.xpos + 3 * body);
    velocities.col(static_cast<Eigen::Index>(i)) = linear + angular.cross(arm);
  }
  return velocities;
}

}  // namespace physpring
