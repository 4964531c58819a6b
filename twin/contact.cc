// SPDX-License-Identifier: Apache-2.0
#include "twin/contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "twin/neighbours.h"

namespace physpring {
namespace {

template <class Real>
Eigen::Matrix<Real, 3, 1> X(const NodeState<Real>& node) {
  return {node.x[0], node.x[1], node.x[2]};
}

template <class Real>
Eigen::Matrix<Real, 3, 1> V(const NodeState<Real>& node) {
  return {node.v[0], node.v[1], node.v[2]};
}

template <class Real>
void SetV(const Eigen::Matrix<Real, 3, 1>& value, NodeState<Real>* node) {
  for (int j = 0; j < 3; ++j) node->v[j] = value[j];
}

template <class Real>
void AddX(const Eigen::Matrix<Real, 3, 1>& value, NodeState<Real>* node) {
  for (int j = 0; j < 3; ++j) node->x[j] += value[j];
}

}  // namespace

template <class Real>
Contact<Real>::Contact(const SpringMassSystem& system, const Environment& environment)
    : nodes_(system.node_count()),
      has_ground_(environment.ground.has_value()),
      distance_(static_cast<Real>(system.contact.collision_distance)) {
  if (has_ground_) {
    ground_normal_ = environment.ground->head<3>().cast<Real>();
    ground_tangents_ = Tangents<Real>(ground_normal_);
    ground_offset_ = static_cast<Real>((*environment.ground)[3]);
  }
  SetParameters(system);
  if (distance_ > 0) {
    never_ = PairsWithin(system.position.leftCols(nodes_), system.contact.collision_distance);
    for (const auto& [a, b] : system.springs) never_.push_back({std::min(a, b), std::max(a, b)});
    std::sort(never_.begin(), never_.end());
  }
}

template <class Real>
void Contact<Real>::SetParameters(const SpringMassSystem& system) {
  laws_ = LawsOf<Real>(system.contact);
  assert(distance_ == static_cast<Real>(system.contact.collision_distance));
  radius_.resize(nodes_);
  mass_.resize(nodes_);
  for (int i = 0; i < nodes_; ++i) {
    radius_[i] = static_cast<Real>(system.contact_radius[i]);
    mass_[i] = static_cast<Real>(system.mass[i]);
  }
}

template <class Real>
typename Contact<Real>::Pairs Contact<Real>::FindPairs(const NodeStates<Real>& state,
                                                       double frame_time) const {
  if (distance_ <= 0) return {};
  Points position(3, nodes_);
  double fastest = 0;
  for (int i = 0; i < nodes_; ++i) {
    for (int j = 0; j < 3; ++j) position(j, i) = static_cast<double>(state[i].x[j]);
    fastest = std::max(
        fastest, std::hypot(static_cast<double>(state[i].v[0]), static_cast<double>(state[i].v[1]),
                            static_cast<double>(state[i].v[2])));
  }
  // two nodes approach by at most twice the fastest motion; more than one distance is not foreseen
  const double margin = std::min(2 * fastest * frame_time, static_cast<double>(distance_));
  Pairs pairs = PairsWithin(position, static_cast<double>(distance_) + margin);
  std::erase_if(pairs, [&](const std::array<int, 2>& pair) {
    return std::binary_search(never_.begin(), never_.end(), pair);
  });
  return pairs;
}

// The impulse that gives a pair alone the relative velocity u' = Impact(u), u = v_b - v_a, divided
// by the number of impacts of the busier of the two; the same on both sides, which keeps momentum:
//   v_a -= m_b / (m_a + m_b) (u' - u) / hits,   v_b += m_a / (m_a + m_b) (u' - u) / hits
template <class Real>
void Contact<Real>::ApplyPairs(const NodeStates<Real>& state, const Pairs& pairs,
                               NodeStates<Real>* next, Impacts* impacts) const {
  for (const Velocity& before : impacts->before) impacts->hits[before.node] = 0;
  impacts->before.clear();
  impacts->collisions.clear();
  if (pairs.empty()) return;
  impacts->hits.resize(nodes_, 0);
  for (const auto& [a, b] : pairs) {
    const Vector d = X(state[b]) - X(state[a]);
    const Real length = d.norm();
    if (length >= distance_ || length < Real(1e-9)) continue;
    const Vector u = V((*next)[b]) - V((*next)[a]);
    if (d.dot(u) >= -Real(kApproach) * length) continue;
    impacts->collisions.push_back({a, b, u, Vector::Zero()});
    for (int i : {a, b}) {
      if (impacts->hits[i]++ == 0) impacts->before.push_back({i, V((*next)[i])});
    }
  }
  for (const auto& [a, b, u, unused] : impacts->collisions) {
    const Vector n = (X(state[b]) - X(state[a])).normalized();
    const Vector change = (Impact(u, n, laws_.object) - u) /
                          static_cast<Real>(std::max(impacts->hits[a], impacts->hits[b]));
    const Real fraction = mass_[a] / (mass_[a] + mass_[b]);
    SetV<Real>(V((*next)[a]) - (1 - fraction) * change, &(*next)[a]);
    SetV<Real>(V((*next)[b]) + fraction * change, &(*next)[b]);
  }
}

template <class Real>
void Contact<Real>::ApplyPairsAdjoint(const NodeStates<Real>& state, Impacts* impacts,
                                      NodeStates<Real>* state_bar,
                                      ContactGradient<Real>* gradient) const {
  for (auto& [a, b, u, u_bar] : impacts->collisions) {
    const Vector d = X(state[b]) - X(state[a]);
    const Real length = d.norm();
    const Vector n = d / length;
    const Real share = 1 / static_cast<Real>(std::max(impacts->hits[a], impacts->hits[b]));
    const Vector change = share * (Impact(u, n, laws_.object) - u);
    const Real mass = mass_[a] + mass_[b];
    const Real fraction = mass_[a] / mass;
    const Vector v_a_bar = V((*state_bar)[a]), v_b_bar = V((*state_bar)[b]);
    // forward: velocity_a -= (1 - fraction) change, velocity_b += fraction change
    const Vector change_bar = fraction * v_b_bar - (1 - fraction) * v_a_bar;
    // forward: fraction = m_a / (m_a + m_b)
    const Real fraction_bar = change.dot(v_a_bar + v_b_bar);
    gradient->mass[a] += fraction_bar * (1 - fraction) / mass;
    gradient->mass[b] -= fraction_bar * fraction / mass;
    // forward: change = share (Impact(u, n) - u)
    u_bar = -share * change_bar;
    Vector n_bar = Vector::Zero();
    ImpactAdjoint<Real>(u, n, laws_.object, share * change_bar, &u_bar, &n_bar,
                        &gradient->laws.object);
    // forward: n = d / |d|
    const Vector d_bar = (n_bar - n.dot(n_bar) * n) / length;
    AddX(d_bar, &(*state_bar)[b]);
    AddX<Real>(-d_bar, &(*state_bar)[a]);
  }
  // forward: u = v_b - v_a; not before all collisions have seen d loss / d velocity after
  for (const auto& [a, b, u, u_bar] : impacts->collisions) {
    SetV<Real>(V((*state_bar)[b]) + u_bar, &(*state_bar)[b]);
    SetV<Real>(V((*state_bar)[a]) - u_bar, &(*state_bar)[a]);
  }
}

template <class Real>
typename Contact<Real>::PlacedGeom Contact<Real>::Place(const Geom& geom, double elapsed) {
  const double speed = geom.angular_velocity.norm();  // rad/s
  Eigen::Matrix3d rotation = geom.rotation;
  if (speed > 0) {
    rotation = Eigen::AngleAxisd(elapsed * speed, geom.angular_velocity / speed) * geom.rotation;
  }
  const Eigen::Vector3d position = geom.position + elapsed * geom.velocity;
  return {geom.half_size.cast<Real>(), static_cast<Real>(geom.radius),
          position.cast<Real>(),       rotation.cast<Real>(),
          geom.velocity.cast<Real>(),  geom.angular_velocity.cast<Real>()};
}

template <class Real>
typename Contact<Real>::Vector Contact<Real>::Offset(const PlacedGeom& geom, const Vector& x) {
  const Vector local = geom.rotation.transpose() * (x - geom.position);
  return local - local.cwiseMax(-geom.half_size).cwiseMin(geom.half_size);
}

template <class Real>
Real Contact<Real>::Gap(const PlacedGeom& geom, const Vector& x, Touch* touch) {
  const Vector arm = x - geom.position;
  touch->surface_velocity = geom.velocity + geom.angular_velocity.cross(arm);
  const Vector offset = Offset(geom, x);
  const Real distance = offset.norm();
  if (distance > 0) {
    touch->normal = geom.rotation * offset / distance;
    return distance - geom.radius;
  }
  // inside the box: towards the nearest face
  const Vector local = geom.rotation.transpose() * arm;
  int axis = 0;
  const Real gap = (local.cwiseAbs() - geom.half_size).maxCoeff(&axis) - geom.radius;
  touch->normal = geom.rotation.col(axis) * (local[axis] < 0 ? Real(-1) : Real(1));
  return gap;
}

template <class Real>
typename Contact<Real>::Vector Contact<Real>::GeomTouchAdjoint(const PlacedGeom& geom,
                                                               const Vector& x,
                                                               const Vector& normal_bar,
                                                               const Vector& surface_velocity_bar) {
  // forward: surface_velocity = velocity + angular_velocity x arm
  Vector x_bar = surface_velocity_bar.cross(geom.angular_velocity);
  // forward: normal = rotation offset / |offset|
  const Vector offset = Offset(geom, x);
  const Real distance = offset.norm();
  if (distance > 0) {
    const Vector n = offset / distance;
    const Vector n_bar = geom.rotation.transpose() * normal_bar;
    Vector offset_bar = (n_bar - n.dot(n_bar) * n) / distance;
    for (int j = 0; j < 3; ++j) {
      if (offset[j] == 0) offset_bar[j] = 0;  // within the box it stays 0
    }
    x_bar += geom.rotation * offset_bar;
  }
  return x_bar;
}

template <class Real>
bool Contact<Real>::Hits(int node, Real gap, Real approach, Real h) const {
  return gap - radius_[node] + h * approach < 0 && approach < -Real(kApproach);
}

template <class Real>
typename Contact<Real>::Vector Contact<Real>::After(const Touch& touch) const {
  const Vector u = touch.velocity_before - touch.surface_velocity;
  return touch.surface_velocity + Impact<Real>(u, touch.normal, laws_.surface);
}

template <class Real>
void Contact<Real>::ApplyTouch(Touch touch, NodeStates<Real>* next, Impacts* impacts) const {
  NodeState<Real>* node = &(*next)[touch.node];
  touch.velocity_before = V(*node);
  SetV(After(touch), node);
  impacts->touches.push_back(touch);
}

template <class Real>
void Contact<Real>::ApplyGround(const NodeStates<Real>& state, Real h, NodeStates<Real>* next,
                                Impacts* impacts) const {
  if (!has_ground_) return;
  const Vector normal = ground_normal_;
  for (int i = 0; i < nodes_; ++i) {
    const Real gap = OrderedDot<Real>(normal, X(state[i])) - ground_offset_;
    if (!Hits(i, gap, OrderedDot<Real>(normal, V((*next)[i])), h)) continue;
    ApplyTouch({i, -1, normal}, next, impacts);
  }
}

template <class Real>
void Contact<Real>::ApplyGeoms(const NodeStates<Real>& state, Real h, NodeStates<Real>* next,
                               Impacts* impacts) const {
  for (std::size_t geom = 0; geom < impacts->geoms.size(); ++geom) {
    for (int i = 0; i < nodes_; ++i) {
      Touch touch{i, static_cast<int>(geom)};
      const Real gap = Gap(impacts->geoms[geom], X(state[i]), &touch);
      const Real approach = touch.normal.dot(V((*next)[i]) - touch.surface_velocity);
      if (Hits(i, gap, approach, h)) ApplyTouch(touch, next, impacts);
    }
  }
}

template <class Real>
void Contact<Real>::ApplyTouchAdjoint(const NodeStates<Real>& state, const Impacts& impacts,
                                      const Touch& touch, NodeStates<Real>* state_bar,
                                      ContactGradient<Real>* gradient) const {
  NodeState<Real>* bar = &(*state_bar)[touch.node];
  const Vector v_bar = V(*bar);
  // forward: v' = s + Impact(v - s, n)
  Vector u_bar = Vector::Zero(), n_bar = Vector::Zero();
  ImpactAdjoint<Real>(touch.velocity_before - touch.surface_velocity, touch.normal, laws_.surface,
                      v_bar, &u_bar, &n_bar, &gradient->laws.surface);
  if (touch.geom >= 0) {
    AddX(GeomTouchAdjoint(impacts.geoms[touch.geom], X(state[touch.node]), n_bar, v_bar - u_bar),
         bar);
  }
  SetV(u_bar, bar);
}

template <class Real>
void Contact<Real>::Apply(const NodeStates<Real>& state, const Pairs& pairs,
                          const std::vector<Geom>& geoms, double elapsed, double h,
                          NodeStates<Real>* next, Impacts* impacts) const {
  impacts->geoms.clear();
  for (const Geom& geom : geoms) impacts->geoms.push_back(Place(geom, elapsed));
  impacts->touches.clear();
  ApplyPairs(state, pairs, next, impacts);
  ApplyGround(state, static_cast<Real>(h), next, impacts);
  ApplyGeoms(state, static_cast<Real>(h), next, impacts);
}

template <class Real>
void Contact<Real>::Undo(const Impacts& impacts, NodeStates<Real>* next) const {
  for (auto touch = impacts.touches.rbegin(); touch != impacts.touches.rend(); ++touch) {
    SetV(touch->velocity_before, &(*next)[touch->node]);
  }
  for (const Velocity& before : impacts.before) SetV(before.v, &(*next)[before.node]);
}

template <class Real>
void Contact<Real>::ApplyAdjoint(const NodeStates<Real>& state, Impacts* impacts,
                                 NodeStates<Real>* state_bar,
                                 ContactGradient<Real>* gradient) const {
  for (auto touch = impacts->touches.rbegin(); touch != impacts->touches.rend(); ++touch) {
    ApplyTouchAdjoint(state, *impacts, *touch, state_bar, gradient);
  }
  ApplyPairsAdjoint(state, impacts, state_bar, gradient);
}

template class Contact<float>;
template class Contact<double>;

}  // namespace physpring
