// SPDX-License-Identifier: Apache-2.0
#include "rollout/soft_points.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
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
    throw Error(fmt::format(
        "{}: has {} flexes{}; a recording is of exactly one, or of bodies joined by such tendons",
        where, model.nflex,
        model.nflex == 0 ? " and no spatial tendons between bodies' sites" : ""));
  }
  if (model.flex_interp[0] != 0) {
    throw Error(where + ": the flex's vertices are interpolated; dof=\"full\" makes them bodies");
  }
}

bool IsAdded(const mjModel& model, int tendon) {
  const char* name = mj_id2name(&model, mjOBJ_TENDON, tendon);
  return name && std::string(name).starts_with(kAddedPrefix);
}

// Sites that spatial tendons run through.
std::set<int> TendonSites(const mjModel& model) {
  std::set<int> sites;
  for (int tendon = 0; tendon < model.ntendon; ++tendon) {
    if (IsAdded(model, tendon)) continue;
    const int first = model.tendon_adr[tendon];
    for (int wrap = first; wrap < first + model.tendon_num[tendon]; ++wrap) {
      if (model.wrap_type[wrap] == mjWRAP_SITE) sites.insert(model.wrap_objid[wrap]);
    }
  }
  return sites;
}

// The body must not be moved by a mocap body and by its own joints.
void CheckNotCarried(const mjModel& model, int body, const std::string& where) {
  for (int b = model.body_parentid[body]; b > 0; b = model.body_parentid[b]) {
    if (model.body_mocapid[b] < 0) continue;
    throw Error(fmt::format(
        "{}: body {} is a jointed child of mocap body {}, which would carry it along; put "
        "the soft body outside and tie the held vertices by <equality><connect>",
        where, BodyName(model, body), BodyName(model, b)));
  }
}

}  // namespace

std::vector<int> SoftPoints::Particles() const {
  std::vector<int> all = points;
  all.insert(all.end(), interior.begin(), interior.end());
  return all;
}

int BodyOf(const mjModel& model, const SoftPoints& soft, int element) {
  return soft.of_flex ? model.flex_vertbodyid[element] : model.site_bodyid[element];
}

SoftPoints FindSoftPoints(const mjModel& model, const std::string& where) {
  SoftPoints result;
  const std::set<int> sites = TendonSites(model);
  result.of_flex = model.nflex > 0 || sites.empty();
  if (result.of_flex) CheckFlex(model, where);
  std::vector<int> elements(sites.begin(), sites.end());
  std::vector<bool> surface(static_cast<std::size_t>(model.nsite), true);
  if (result.of_flex) {
    surface = SurfaceVertices(model);
    elements.resize(surface.size());
    std::iota(elements.begin(), elements.end(), 0);
  }
  const std::vector<std::vector<int>> tied = TiedBodies(model);
  std::set<int> bodies;  // that carry elements and have a mass of their own
  bool held_by_mocap = false;
  for (const int element : elements) {
    const int body = BodyOf(model, result, element);
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
    (held                                         ? result.controllers
     : surface[static_cast<std::size_t>(element)] ? result.points
                                                  : result.interior)
        .push_back(element);
  }
  const char* kind = result.of_flex ? "flex" : "body of tendons";
  if (result.points.empty()) {
    throw Error(fmt::format("{}: the {} is rigid: all of it is held", where, kind));
  }
  if (!held_by_mocap) {
    throw Error(fmt::format(
        "{}: no mocap body holds the {}; tie a part of it to one by <equality><connect>", where,
        kind));
  }
  for (const int body : bodies) result.mass += model.body_mass[body];
  return result;
}

Points PositionsOf(const mjData& data, const SoftPoints& soft, const std::vector<int>& elements) {
  const mjtNum* places = soft.of_flex ? data.flexvert_xpos : data.site_xpos;
  Points positions(3, static_cast<Eigen::Index>(elements.size()));
  for (std::size_t i = 0; i < elements.size(); ++i) {
    positions.col(static_cast<Eigen::Index>(i)) =
        Eigen::Map<const Eigen::Vector3d>(places + 3 * elements[i]);
  }
  return positions;
}

Points VelocitiesOf(const mjModel& model, const mjData& data, const SoftPoints& soft,
                    const std::vector<int>& elements) {
  const Points places = PositionsOf(data, soft, elements);
  Points velocities(3, places.cols());
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const int body = BodyOf(model, soft, elements[i]);
    Eigen::Matrix<double, 6, 1> motion;  // the body frame's: angular, linear; world axes
    mj_objectVelocity(&model, &data, mjOBJ_XBODY, body, motion.data(), 0);
    const Eigen::Vector3d angular = motion.head<3>(), linear = motion.tail<3>();
    const Eigen::Vector3d arm = places.col(static_cast<Eigen::Index>(i)) -
                                Eigen::Map<const Eigen::Vector3d>(data.xpos + 3 * body);
    velocities.col(static_cast<Eigen::Index>(i)) = linear + angular.cross(arm);
  }
  return velocities;
}

std::vector<int> GeomsInTheWay(const mjModel& model, const SoftPoints& soft) {
  if (model.opt.disableflags & mjDSBL_CONTACT) return {};
  std::set<int> own;  // geoms of the body
  int type = 0, affinity = 0;
  if (soft.of_flex) {
    type = model.flex_contype[0];
    affinity = model.flex_conaffinity[0];
  } else {
    for (const int element : soft.Particles()) {
      const int body = BodyOf(model, soft, element);
      for (int i = 0; i < model.body_geomnum[body]; ++i) {
        const int geom = model.body_geomadr[body] + i;
        own.insert(geom);
        type |= model.geom_contype[geom];
        affinity |= model.geom_conaffinity[geom];
      }
    }
  }
  std::vector<int> others;
  for (int geom = 0; geom < model.ngeom; ++geom) {
    if (own.contains(geom)) continue;
    if ((model.geom_contype[geom] & affinity) != 0 || (model.geom_conaffinity[geom] & type) != 0) {
      others.push_back(geom);
    }
  }
  return others;
}

bool IsGround(const mjModel& model, int geom) {
  return model.geom_type[geom] == mjGEOM_PLANE && model.body_weldid[model.geom_bodyid[geom]] == 0;
}

}  // namespace physpring
