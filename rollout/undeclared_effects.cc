// SPDX-License-Identifier: Apache-2.0
#include "rollout/undeclared_effects.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "rollout/scene.h"
#include "twin/error.h"

namespace physpring {
namespace {

constexpr double kLeastStiffness = 0.1;                          // part of it that a drift leaves
constexpr double kCore = 0.03;                                   // m, of the attraction
constexpr double kCircle = 0.12, kCircleRate = 8, kBelow = 0.1;  // its way: m, rad/s, m
constexpr char kAnchorName[] = "undeclared anchor";

Eigen::Map<Eigen::Vector3d> At(mjtNum* values, int i) {
  return Eigen::Map<Eigen::Vector3d>(values + 3 * i);
}

// A tendon without thickness from site to site.
mjsTendon* AddTendon(mjSpec* spec, const std::string& name, const std::string& from,
                     const std::string& to) {
  mjsTendon* tendon = mjs_addTendon(spec, nullptr);
  mjs_setName(tendon->element, (kAddedPrefix + name).c_str());
  mjs_wrapSite(tendon, from.c_str());
  mjs_wrapSite(tendon, to.c_str());
  return tendon;
}

}  // namespace

UndeclaredEffects::UndeclaredEffects(const SceneEffects& effects, const mjModel& plain,
                                     const SoftPoints& soft, const std::string& where)
    : plain_(plain), soft_(soft), particles_(soft.Particles()) {
  try {
    ExpectEffects(effects);
  } catch (const Error& error) {
    throw Error(where + ": " + error.what());
  }
  values_ = effects;
  std::erase_if(values_, [&](const auto& entry) {
    return !Has(entry.first.substr(0, entry.first.find('.')));
  });
  std::string possible;
  for (const EffectKey& key : EffectKeys()) {
    if (key.amount && WhyNot(key).empty()) possible += (possible.empty() ? "" : ", ") + key.name;
  }
  for (const EffectKey& key : EffectKeys()) {
    if (!values_.contains(key.name) || WhyNot(key).empty()) continue;
    throw Error(fmt::format("{}: cannot have the effect {}: {}; it can have {}", where, key.name,
                            WhyNot(key), possible));
  }
  const DataPtr data = MakeData(plain);
  mj_kinematics(&plain, data.get());
  mj_comPos(&plain, data.get());
  mj_flex(&plain, data.get());
  reference_ = PositionsOf(*data, soft, particles_);
  held_ = PositionsOf(*data, soft, soft.controllers);
  vertices_ = Eigen::Map<const Points>(data->flexvert_xpos, 3, plain.nflexvert);
  sites_ = Eigen::Map<const Points>(data->site_xpos, 3, plain.nsite);
}

bool UndeclaredEffects::Has(const std::string& effect) const {
  return std::any_of(EffectKeys().begin(), EffectKeys().end(), [&](const EffectKey& key) {
    return key.amount && key.effect() == effect && Value(key.name) != 0;
  });
}

double UndeclaredEffects::Value(const std::string& key, double otherwise) const {
  const auto found = values_.find(key);
  return found == values_.end() ? otherwise : found->second;
}

Eigen::Vector3d UndeclaredEffects::Vector(const std::string& key, const std::string& unit,
                                          const Eigen::Vector3d& otherwise) const {
  return {Value(key + "_x_" + unit, otherwise[0]), Value(key + "_y_" + unit, otherwise[1]),
          Value(key + "_z_" + unit, otherwise[2])};
}

std::string UndeclaredEffects::WhyNot(const EffectKey& key) const {
  const std::set<std::string> of_tendons = {
      "dry_friction.slip_strain", "stiffening.cubic_stiffness_ratio", "tension_only.slack_share"};
  if (soft_.of_flex && of_tendons.contains(key.name)) return "its body is not made of tendons";
  if (soft_.of_flex && key.effect() == "yield" && plain_.flex_dim[0] == 1) {
    return "MuJoCo's flexes of lines do not yield";
  }
  if (key.name == "tension_only.slack_share" && Value(key.name, 1) != 1 && Value(key.name) != 0) {
    return "MuJoCo's springs are slack wholly, 1, or not";
  }
  const std::vector<int> geoms = GeomsInTheWay(plain_, soft_);
  const bool grounded =
      std::any_of(geoms.begin(), geoms.end(), [&](int geom) { return IsGround(plain_, geom); });
  if (key.effect() == "ground_contact" && !grounded) return "it has no ground";
  return "";
}

// Which particle is next to the place; by default the one farthest from all controllers.
int UndeclaredEffects::Place(const std::string& effect) const {
  Eigen::VectorXd away(reference_.cols());
  for (Eigen::Index i = 0; i < away.size(); ++i) {
    away[i] = (held_.colwise() - reference_.col(i)).colwise().squaredNorm().minCoeff();
  }
  Eigen::Index end = 0, nearest = 0;
  away.maxCoeff(&end);
  const Eigen::Vector3d place = Vector(effect + ".place", "m", reference_.col(end));
  (reference_.colwise() - place).colwise().squaredNorm().minCoeff(&nearest);
  return static_cast<int>(nearest);
}

double UndeclaredEffects::RestStrain(const Eigen::Vector3d& place) const {
  Points all(3, reference_.cols() + held_.cols());
  all << reference_, held_;
  const Eigen::Vector3d low = all.rowwise().minCoeff(), size = all.rowwise().maxCoeff() - low;
  Eigen::Index axis = 0;
  size.maxCoeff(&axis);
  const double s = (place[axis] - low[axis]) / size[axis];
  return (1 - s) * Value("rest_length.strain_low_end") + s * Value("rest_length.strain_high_end");
}

void UndeclaredEffects::Edit(mjSpec* spec) const {
  if (soft_.of_flex) {
    mjs_asFlex(mjs_firstElement(spec, mjOBJ_FLEX))->stressyield[0] += Value("yield.yield_strain");
    if (Has("stiffening") || Has("dry_friction")) AddEdgeTendons(spec);
  } else {
    EditTendons(spec);
  }
  if (Has("tether")) AddTether(spec);
}

void UndeclaredEffects::EditTendons(mjSpec* spec) const {
  int e = 0;
  for (mjsElement* element = mjs_firstElement(spec, mjOBJ_TENDON); element;
       element = mjs_nextElement(spec, element), ++e) {
    mjsTendon& tendon = *mjs_asTendon(element);
    const int first = plain_.tendon_adr[e], last = first + plain_.tendon_num[e] - 1;
    if (plain_.wrap_type[first] != mjWRAP_SITE || plain_.wrap_type[last] != mjWRAP_SITE) continue;
    const double k = plain_.tendon_stiffness[e], length = plain_.tendon_lengthspring[2 * e + 1];
    tendon.stiffness[2] += Value("stiffening.cubic_n_per_m3");
    tendon.stiffness[2] += Value("stiffening.cubic_stiffness_ratio") * k / (length * length);
    tendon.frictionloss += Value("dry_friction.force_n");
    tendon.frictionloss += Value("dry_friction.slip_strain") * k * length;
    tendon.springyield += Value("yield.yield_strain") * length;
    if (Has("rest_length")) {
      const Eigen::Vector3d middle =
          (sites_.col(plain_.wrap_objid[first]) + sites_.col(plain_.wrap_objid[last])) / 2;
      for (int bound : {0, 1}) {
        tendon.springlength[bound] =
            plain_.tendon_lengthspring[2 * e + bound] * (1 + RestStrain(middle));
      }
    }
    if (Has("tension_only")) {
      tendon.springlength[0] = 0;
      tendon.springlength[1] = length;
    }
  }
}

std::string UndeclaredEffects::SiteOn(int element, mjSpec* spec) const {
  if (!soft_.of_flex) return mj_id2name(&plain_, mjOBJ_SITE, element);
  const std::string name = fmt::format("{}{}", kAddedPrefix, element);
  if (mjs_findElement(spec, mjOBJ_SITE, name.c_str())) return name;
  const char* body = mj_id2name(&plain_, mjOBJ_BODY, BodyOf(plain_, soft_, element));
  mjsSite* site = mjs_addSite(mjs_findBody(spec, body), nullptr);
  mjs_setName(site->element, name.c_str());
  At(site->pos, 0) = Eigen::Map<const Eigen::Vector3d>(plain_.flex_vert + 3 * element);
  return name;
}

void UndeclaredEffects::AddEdgeTendons(mjSpec* spec) const {
  for (int e = 0; e < plain_.flex_edgenum[0]; ++e) {
    if (plain_.flexedge_rigid[e]) continue;
    const int p = plain_.flex_edge[2 * e], q = plain_.flex_edge[2 * e + 1];
    const std::string from = SiteOn(p, spec), to = SiteOn(q, spec);
    mjsTendon* tendon = AddTendon(spec, fmt::format("edge {}", e), from, to);
    tendon->stiffness[2] = Value("stiffening.cubic_n_per_m3");
    tendon->frictionloss = Value("dry_friction.force_n");
    const double length = (vertices_.col(p) - vertices_.col(q)).norm();
    tendon->springlength[0] = tendon->springlength[1] = length;
  }
}

void UndeclaredEffects::AddTether(mjSpec* spec) const {
  const int place = Place("tether");
  mjsSite* anchor = mjs_addSite(mjs_findBody(spec, "world"), nullptr);
  mjs_setName(anchor->element, kAnchorName);
  At(anchor->pos, 0) = Vector("tether.anchor", "m", reference_.col(place));
  mjsTendon* tendon = AddTendon(
      spec, "tether", SiteOn(particles_[static_cast<std::size_t>(place)], spec), kAnchorName);
  tendon->stiffness[0] = Value("tether.stiffness_n_per_m");
  tendon->damping[0] = Value("tether.damping_n_s_per_m");
  tendon->springlength[0] = tendon->springlength[1] = 0;
}

void UndeclaredEffects::Change(mjModel* model) const {
  if (Has("mass_distribution")) ChangeMass(model);  // first: it computes constants anew
  if (Has("gravity_direction")) {
    const Eigen::Vector3d turn(Value("gravity_direction.tilt_x_rad"),
                               Value("gravity_direction.tilt_y_rad"), 0);
    Eigen::Map<Eigen::Vector3d> gravity(model->opt.gravity);
    gravity = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * Eigen::Vector3d(gravity);
  }
  if (Has("air_drag")) {
    model->opt.density += AirDensity(model);
    Eigen::Map<Eigen::Vector3d>(model->opt.wind) +=
        Vector("air_drag.wind", "m_per_s", Eigen::Vector3d::Zero());
  }
  if (Has("ground_contact")) ChangeFriction(model);
  if (Has("rest_length") && soft_.of_flex) ChangeFlexLengths(model);
}

// The one with which a wind of 1 m/s on the body in its reference configuration has a force of the
// drag coefficient, along the axis where that is largest.
double UndeclaredEffects::AirDensity(mjModel* model) const {
  const mjOption before = model->opt;
  const DataPtr data = MakeData(*model);
  std::set<int> bodies;
  for (const int element : soft_.Particles()) bodies.insert(BodyOf(plain_, soft_, element));
  double most = 0;
  for (int axis = 0; axis < 3; ++axis) {
    model->opt.density = 1;
    model->opt.viscosity = 0;
    for (int i = 0; i < 3; ++i) model->opt.wind[i] = i == axis ? 1 : 0;
    mj_forward(model, data.get());
    double force = 0;
    for (int dof = 0; dof < model->nv; ++dof) {
      if (!bodies.contains(model->dof_bodyid[dof])) continue;
      force += data->qfrc_fluid[dof] * data->cdof[6 * dof + 3 + axis];
    }
    most = std::max(most, force);
  }
  model->opt = before;
  return most > 0 ? Value("air_drag.drag_kg_per_m") / most : 0;
}

void UndeclaredEffects::ChangeMass(mjModel* model) const {
  const auto place = static_cast<std::size_t>(Place("mass_distribution"));
  const int body = BodyOf(plain_, soft_, particles_[place]);
  const double mass = model->body_mass[body] + Value("mass_distribution.mass_kg");
  // as large as before: MuJoCo's fluid forces take the size from mass and inertia
  At(model->body_inertia, body) *= mass / model->body_mass[body];
  model->body_mass[body] = mass;
  const DataPtr data = MakeData(*model);
  mj_setConst(model, data.get());
}

// MuJoCo takes the larger friction of the two in contact, or that of the higher priority: both get
// the new one.
void UndeclaredEffects::ChangeFriction(mjModel* model) const {
  std::vector<mjtNum*> body;
  if (soft_.of_flex) {
    body.push_back(model->flex_friction);
  } else {
    for (int geom = 0; geom < model->ngeom; ++geom) {
      for (const int element : particles_) {
        if (model->geom_bodyid[geom] != BodyOf(plain_, soft_, element)) continue;
        body.push_back(model->geom_friction + 3 * geom);
        break;
      }
    }
  }
  for (const int ground : GeomsInTheWay(plain_, soft_)) {
    if (!IsGround(plain_, ground)) continue;
    double friction = plain_.geom_friction[3 * ground];
    for (const mjtNum* part : body) friction = std::max(friction, *part);
    friction = std::max(0.0, friction + Value("ground_contact.friction_change"));
    for (mjtNum* part : body) *part = friction;
    model->geom_friction[3 * ground] = friction;
  }
}

void UndeclaredEffects::ChangeFlexLengths(mjModel* model) const {
  for (int e = 0; e < plain_.flex_edgenum[0]; ++e) {
    const int p = plain_.flex_edge[2 * e], q = plain_.flex_edge[2 * e + 1];
    model->flexedge_length0[e] *= 1 + RestStrain((vertices_.col(p) + vertices_.col(q)) / 2);
  }
}

void UndeclaredEffects::Drive(double time, mjModel* model, mjData* data) const {
  if (time < 0) return;
  if (Has("stiffness_drift")) {
    const double part =
        std::max(kLeastStiffness, 1 + Value("stiffness_drift.relative_rate_per_s") * time);
    const auto scale = [&](const mjtNum* from, auto count, mjtNum* to) {
      for (decltype(count) i = 0; i < count; ++i) to[i] = part * from[i];
    };
    scale(plain_.tendon_stiffness, plain_.ntendon, model->tendon_stiffness);
    scale(plain_.flex_edgestiffness, plain_.nflex, model->flex_edgestiffness);
    scale(plain_.flex_stiffness, plain_.nflexstiffness, model->flex_stiffness);
    scale(plain_.flex_bending, plain_.nflexbending, model->flex_bending);
  }
  if (Has("uniform_force") || Has("moving_attraction")) DriveForces(time, model, data);
}

void UndeclaredEffects::DriveForces(double time, mjModel* model, mjData* data) const {
  mj_kinematics(model, data);
  const Eigen::Vector3d amplitude = Vector("uniform_force.force", "n", Eigen::Vector3d::Zero());
  const double period = Value("uniform_force.period_s");
  const Eigen::Vector3d force =
      period > 0 ? std::sin(2 * std::numbers::pi * time / period) * amplitude : amplitude;
  const Eigen::Vector3d middle = reference_.rowwise().mean() - kBelow * Eigen::Vector3d::UnitZ();
  const double angle = Value("moving_attraction.rate_rad_per_s", kCircleRate) * time;
  const Eigen::Vector3d point = Vector("moving_attraction.centre", "m", middle) +
                                Value("moving_attraction.radius_m", kCircle) *
                                    Eigen::Vector3d(std::sin(angle), std::cos(angle), 0);
  std::set<int> bodies;
  for (const int element : particles_) bodies.insert(BodyOf(plain_, soft_, element));
  double total = 0;
  for (const int body : bodies) total += model->body_mass[body];
  for (const int body : bodies) {
    const Eigen::Vector3d away = point - At(data->xipos, body);
    const double share = model->body_mass[body] / total;
    const double pull = Value("moving_attraction.strength_n_m2") /
                        std::pow(away.squaredNorm() + kCore * kCore, 1.5);
    Eigen::Map<Eigen::Vector3d>(data->xfrc_applied + 6 * body) = share * (force + pull * away);
  }
}

}  // namespace physpring
