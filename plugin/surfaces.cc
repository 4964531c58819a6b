// SPDX-License-Identifier: Apache-2.0
#include "plugin/surfaces.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <string_view>

namespace physpring {
namespace {

using Vector = Eigen::Vector3d;

// Part of an overlap that is undone in a step.
constexpr double kRecovery = 0.2;
// Overlap with a fixed surface that is let be, m.
constexpr double kAllowed = 1e-3;
// How fast a fixed surface pushes a node out at most, m/s: it then rises by 2 mm.
constexpr double kFastestRecovery = 0.2;
// A body is heavy to nodes that weigh less than this part of what it shows them.
constexpr double kHeavy = 0.1;
// The bound of the contact law.
constexpr double kMostFriction = 2;

Eigen::Map<const Vector> X(const NodeState<double>& node) {
  return Eigen::Map<const Vector>(node.x);
}

Eigen::Matrix3d Cross(const Vector& r) {
  Eigen::Matrix3d cross;
  cross << 0, -r[2], r[1], r[2], 0, -r[0], -r[1], r[0], 0;
  return cross;
}

// A force (N) or impulse (N s) at the end of an arm, with its moment: first the angular part.
Eigen::Matrix<double, 6, 1> Wrench(const Vector& arm, const Vector& force) {
  Eigen::Matrix<double, 6, 1> wrench;
  wrench << arm.cross(force), force;
  return wrench;
}

// The instance of another twin that `body` is a node of; -1 = none.
int InstanceOfNode(const mjModel* model, int body) {
  const int instance = model->body_plugin[model->body_parentid[model->body_weldid[body]]];
  if (instance < 0 || model->body_weldid[body] == 0) return -1;
  const std::string_view name = mjp_getPluginAtSlot(model->plugin[instance])->name;
  return name.starts_with("physpring.") ? instance : -1;
}

}  // namespace

Surfaces::Surfaces(const mjModel* model, int instance, const Level& level)
    : instance_(instance),
      node_of_body_(model->nbody, -1),
      level_(&level),
      laws_(LawsOf<double>(level.system.contact)),
      mocaps_(model) {
  const std::vector<int>& nodes = level.bodies.nodes;
  for (int body = 1; body < model->nbody; ++body) {
    const auto node = std::find(nodes.begin(), nodes.end(), model->body_weldid[body]);
    if (node != nodes.end()) node_of_body_[body] = static_cast<int>(node - nodes.begin());
  }
}

void Surfaces::Forget() {
  touches_.clear();
  bodies_.clear();
  fixed_ = 0;
}

void Surfaces::Collect(const mjModel* model, mjData* data, const NodeStates<double>& state,
                       const double* poses) {
  Forget();
  recovery_rate_ = kRecovery / model->opt.timestep;
  if (!level_->has_surface) return;
  for (int i = 0; i < data->ncon; ++i) CollectContact(model, data, state, poses, data->contact[i]);
  LetHeavyBodiesGoOn();
  // as in twin/contact.h: the ground before the geoms that move
  const auto first_moving =
      std::stable_partition(touches_.begin(), touches_.end(),
                            [&](const Touch& touch) { return !bodies_[touch.body].moves; });
  fixed_ = static_cast<std::size_t>(first_moving - touches_.begin());
}

void Surfaces::LetHeavyBodiesGoOn() {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (!bodies_[b].moves) continue;
    double nodes = 0;  // kg
    for (const Touch& touch : touches_) {
      if (touch.body == static_cast<int>(b)) nodes += level_->system.mass[touch.node];
    }
    auto& inverse = bodies_[b].inverse_inertia;
    if (nodes * inverse.diagonal().tail<3>().maxCoeff() < kHeavy) inverse.setZero();
  }
}

void Surfaces::CollectContact(const mjModel* model, mjData* data, const NodeStates<double>& state,
                              const double* poses, const mjContact& contact) {
  if (contact.includemargin >= 0) return;                  // left to MuJoCo
  if (contact.geom[0] < 0 || contact.geom[1] < 0) return;  // a flex
  int node = -1, node_geom = 0, other_body = 0;
  for (int side : {0, 1}) {
    const int body = model->geom_bodyid[contact.geom[side]];
    if (node_of_body_[body] < 0) {
      other_body = body;
    } else if (node >= 0) {
      return;  // two nodes of ours: twin/contact.h
    } else {
      node = node_of_body_[body];
      node_geom = side;
    }
  }
  if (node < 0) return;
  const int other_instance = InstanceOfNode(model, other_body);
  if (other_instance >= 0 && other_instance < instance_) return;  // answers for both

  const Vector normal = Eigen::Map<const Vector>(contact.frame) * (node_geom == 0 ? -1.0 : 1.0);
  double gap = contact.dist;
  const int geom = contact.geom[node_geom];
  if (level_->has_contact_radius && model->geom_type[geom] == mjGEOM_SPHERE) {
    gap += model->geom_size[3 * geom] - level_->system.contact_radius[node];
  }
  ContactPair<double> law = other_instance >= 0 ? laws_.object : laws_.surface;
  const int other_geom = contact.geom[1 - node_geom];
  if (model->geom_priority[other_geom] > model->geom_priority[geom]) {
    const double friction = std::min(model->geom_friction[3 * other_geom], kMostFriction);
    law = {.friction = friction, .cone = law.cone};
  }
  const int index = FindBody(model, data, poses, other_body);
  const Body& body = bodies_[index];
  // by the velocity half way: the centre goes on
  const Vector half_way = body.centre + 0.5 * body.lead * body.velocity.tail<3>();
  const Vector surface =
      body.velocity.tail<3>() + body.velocity.head<3>().cross(X(state[node]) - half_way);
  touches_.push_back({node, index, law, normal, X(state[node]), gap,
                      -body.lead * normal.dot(surface), Vector6::Zero()});
}

int Surfaces::FindBody(const mjModel* model, mjData* data, const double* poses, int body) {
  const auto known = std::find_if(bodies_.begin(), bodies_.end(),
                                  [&](const Body& other) { return other.id == body; });
  if (known != bodies_.end()) return static_cast<int>(known - bodies_.begin());

  const int root = model->body_weldid[body];
  Body found{body,
             false,
             0,
             Eigen::Map<const Vector>(data->xipos + 3 * body),
             Vector6::Zero(),
             Vector6::Zero(),
             Eigen::Matrix<double, 6, 6>::Zero()};
  if (model->body_mocapid[root] >= 0) {
    ReadMocapMotion(model, data, poses, &found);
  } else if (root != 0) {
    ReadMotion(model, data, &found);
  }
  bodies_.push_back(found);
  return static_cast<int>(bodies_.size()) - 1;
}

void Surfaces::ReadMocapMotion(const mjModel* model, const mjData* data, const double* poses,
                               Body* body) {
  body->velocity = mocaps_.Velocity(model, data, body->id, poses);
  body->moves = !body->velocity.isZero(0);
  body->lead = model->opt.timestep;
  body->centre -= body->lead * body->velocity.tail<3>();
}

void Surfaces::ReadMotion(const mjModel* model, mjData* data, Body* body) {
  body->moves = true;
  mj_objectVelocity(model, data, mjOBJ_BODY, body->id, body->velocity.data(), 0);
  using Rows = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor>;
  const int nv = model->nv;
  jacobian_.resize(6 * static_cast<std::size_t>(nv));
  solution_.resize(jacobian_.size());
  mj_jacBodyCom(model, data, jacobian_.data() + 3 * nv, jacobian_.data(), body->id);
  mj_solveM(model, data, solution_.data(), jacobian_.data(), 6);
  body->inverse_inertia = Eigen::Map<const Rows>(jacobian_.data(), 6, nv) *
                          Eigen::Map<const Rows>(solution_.data(), 6, nv).transpose();
}

double Surfaces::Gap(const Touch& touch, const Vector& x) {
  return touch.gap + touch.normal.dot(x - touch.start) - touch.advanced;
}

Vector Surfaces::HitFixed(const Vector& x, const Vector& v, double h, Touch* touch) const {
  const Vector& n = touch->normal;
  const double gap = Gap(*touch, x), approach = n.dot(v);
  const bool hits = gap + h * approach < 0 && approach < -kApproach;
  if (!hits && gap >= -kAllowed) return v;
  Vector after = hits ? Impact(v, n, touch->law) : v;
  if (gap < -kAllowed) {
    const double least = std::min(recovery_rate_ * (-gap - kAllowed), kFastestRecovery);
    after += std::max(least - n.dot(after), 0.0) * n;
  }
  const double mass = level_->system.mass[touch->node];
  touch->impulse += Wrench(x - bodies_[touch->body].centre, mass * (v - after));
  return after;
}

Vector Surfaces::HitMoving(const Vector& x, const Vector& v, double h, Touch* touch) {
  Body& body = bodies_[touch->body];
  const Vector arm = x - body.centre;
  Eigen::Matrix<double, 3, 6> at_node;  // velocity of the surface from that of the body
  at_node << -Cross(arm), Eigen::Matrix3d::Identity();
  Vector surface = at_node * body.velocity;
  const double gap = Gap(*touch, x);
  // a body that overlaps the node pushes it out
  surface += recovery_rate_ * std::max(-gap, 0.0) * touch->normal;
  const Vector u = v - surface;
  const double approach = touch->normal.dot(u);
  if (gap + h * approach >= 0 || approach >= -kApproach) return v;
  const Vector after = Impact(u, touch->normal, touch->law);
  const double mass = level_->system.mass[touch->node];
  const Eigen::Matrix3d inverse_mass =
      Eigen::Matrix3d::Identity() / mass + at_node * body.inverse_inertia * at_node.transpose();
  const Vector impulse = inverse_mass.inverse() * (after - u);
  const Vector6 reaction = Wrench(arm, -impulse);
  touch->impulse += reaction;
  body.velocity += body.inverse_inertia * reaction;
  body.impulse += reaction;
  return v + impulse / mass;
}

void Surfaces::Apply(const NodeStates<double>& state, double h, NodeStates<double>* next) {
  for (std::size_t i = 0; i < touches_.size(); ++i) {
    Touch& touch = touches_[i];
    Eigen::Map<Vector> v((*next)[touch.node].v);
    const Vector x = X(state[touch.node]);
    v = i < fixed_ ? HitFixed(x, v, h, &touch) : HitMoving(x, v, h, &touch);
  }
  for (std::size_t i = fixed_; i < touches_.size(); ++i) {
    Touch& touch = touches_[i];
    const Body& body = bodies_[touch.body];
    const Vector arm = X(state[touch.node]) - body.centre;
    const Vector surface = body.velocity.tail<3>() + body.velocity.head<3>().cross(arm);
    touch.advanced += h * touch.normal.dot(surface);
  }
  for (Body& body : bodies_) body.centre += h * body.velocity.tail<3>();
}

void Surfaces::AddReactions(const mjModel* model, mjData* data, double time) const {
  for (const Body& body : bodies_) {
    if (!body.moves) continue;
    const Vector6 mean = body.impulse / time;
    mj_applyFT(model, data, mean.data() + 3, mean.data(), data->xipos + 3 * body.id, body.id,
               data->qfrc_passive);
  }
}

}  // namespace physpring
