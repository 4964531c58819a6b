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
  const ContactCoefficients& c = system.contact;
  laws_.surface = {static_cast<Real>(c.restitution), static_cast<Real>(c.friction)};
  laws_.object = {static_cast<Real>(c.object_restitution), static_cast<Real>(c.object_friction)};
  assert(distance_ == static_cast<Real>(c.collision_distance));
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

template <class Real>
bool Contact<Real>::PairHits(const NodeStates<Real>& state, const std::array<int, 2>& pair,
                             const Velocities& velocity) const {
  const Vector d = X(state[pair[1]]) - X(state[pair[0]]);
  const Real length = d.norm();
  if (length >= distance_ || length < Real(1e-9)) return false;
  return d.dot(velocity[pair[1]] - velocity[pair[0]]) < -Real(kApproach) * length;
}

// Number of impacts of each node.
template <class Real>
std::vector<int> Contact<Real>::CountHits(const NodeStates<Real>& state, const Pairs& pairs,
                                          const Velocities& velocity) const {
  std::vector<int> hits(nodes_, 0);
  for (const std::array<int, 2>& pair : pairs) {
    if (!PairHits(state, pair, velocity)) continue;
    ++hits[pair[0]];
    ++hits[pair[1]];
  }
  return hits;
}

// The impulse that gives a pair alone the relative velocity u' = Impact(u), u = v_b - v_a, divided
// by the number of impacts of the busier of the two; the same on both sides, which keeps momentum:
//   v_a -= m_b / (m_a + m_b) (u' - u) / hits,   v_b += m_a / (m_a + m_b) (u' - u) / hits
template <class Real>
void Contact<Real>::ApplyPairs(const NodeStates<Real>& state, const Pairs& pairs,
                               Velocities* velocity) const {
  const Velocities before = *velocity;
  const std::vector<int> hits = CountHits(state, pairs, before);
  for (const auto& pair : pairs) {
    if (!PairHits(state, pair, before)) continue;
    const auto [a, b] = pair;
    const Vector n = (X(state[b]) - X(state[a])).normalized();
    const Vector u = before[b] - before[a];
    const Vector change =
        (Impact(u, n, laws_.object) - u) / static_cast<Real>(std::max(hits[a], hits[b]));
    const Real fraction = mass_[a] / (mass_[a] + mass_[b]);
    (*velocity)[a] -= (1 - fraction) * change;
    (*velocity)[b] += fraction * change;
  }
}

template <class Real>
void Contact<Real>::ApplyPairsAdjoint(const NodeStates<Real>& state, const Pairs& pairs,
                                      const Velocities& velocity, Velocities* velocity_bar,
                                      ContactGradient<Real>* gradient) const {
  const Velocities after_bar = *velocity_bar;
  const std::vector<int> hits = CountHits(state, pairs, velocity);
  for (const auto& pair : pairs) {
    if (!PairHits(state, pair, velocity)) continue;
    const auto [a, b] = pair;
    const Vector d = X(state[b]) - X(state[a]);
    const Real length = d.norm();
    const Vector n = d / length;
    const Vector u = velocity[b] - velocity[a];
    const Real share = 1 / static_cast<Real>(std::max(hits[a], hits[b]));
    const Vector change = share * (Impact(u, n, laws_.object) - u);
    const Real mass = mass_[a] + mass_[b];
    const Real fraction = mass_[a] / mass;
    // forward: velocity_a -= (1 - fraction) change, velocity_b += fraction change
    const Vector change_bar = fraction * after_bar[b] - (1 - fraction) * after_bar[a];
    // forward: fraction = m_a / (m_a + m_b)
    const Real fraction_bar = change.dot(after_bar[a] + after_bar[b]);
    gradient->mass[a] += fraction_bar * (1 - fraction) / mass;
    gradient->mass[b] -= fraction_bar * fraction / mass;
    // forward: change = share (Impact(u, n) - u)
    Vector u_bar = -share * change_bar, n_bar = Vector::Zero();
    ImpactAdjoint<Real>(u, n, laws_.object, share * change_bar, &u_bar, &n_bar,
                        &gradient->laws.object);
    (*velocity_bar)[b] += u_bar;
    (*velocity_bar)[a] -= u_bar;
    // forward: n = d / |d|
    const Vector d_bar = (n_bar - n.dot(n_bar) * n) / length;
    AddX(d_bar, &gradient->state[b]);
    AddX<Real>(-d_bar, &gradient->state[a]);
  }
}

template <class Real>
std::vector<typename Contact<Real>::PlacedGeom> Contact<Real>::Place(const std::vector<Geom>& geoms,
                                                                     double elapsed) {
  std::vector<PlacedGeom> placed;
  for (const Geom& geom : geoms) {
    const double speed = geom.angular_velocity.norm();  // rad/s
    Eigen::Matrix3d rotation = geom.rotation;
    if (speed > 0) {
      rotation = Eigen::AngleAxisd(elapsed * speed, geom.angular_velocity / speed) * geom.rotation;
    }
    const Eigen::Vector3d position = geom.position + elapsed * geom.velocity;
    placed.push_back({geom.half_size.cast<Real>(), static_cast<Real>(geom.radius),
                      position.cast<Real>(), rotation.cast<Real>(), geom.velocity.cast<Real>(),
                      geom.angular_velocity.cast<Real>()});
  }
  return placed;
}

template <class Real>
typename Contact<Real>::Touch Contact<Real>::GroundTouch(const Vector& x) const {
  Touch touch;
  touch.normal = ground_normal_;
  touch.gap = ground_normal_.dot(x) - ground_offset_;
  return touch;
}

template <class Real>
typename Contact<Real>::Vector Contact<Real>::Offset(const PlacedGeom& geom, const Vector& x) {
  const Vector local = geom.rotation.transpose() * (x - geom.position);
  return local - local.cwiseMax(-geom.half_size).cwiseMin(geom.half_size);
}

template <class Real>
typename Contact<Real>::Touch Contact<Real>::GeomTouch(const PlacedGeom& geom, const Vector& x) {
  Touch touch;
  touch.geom = &geom;
  const Vector arm = x - geom.position;
  const Vector offset = Offset(geom, x);
  const Real distance = offset.norm();
  if (distance > 0) {
    touch.normal = geom.rotation * offset / distance;
    touch.gap = distance - geom.radius;
  } else {  // inside the box: towards the nearest face
    const Vector local = geom.rotation.transpose() * arm;
    int axis = 0;
    touch.gap = (local.cwiseAbs() - geom.half_size).maxCoeff(&axis) - geom.radius;
    touch.normal = geom.rotation.col(axis) * (local[axis] < 0 ? Real(-1) : Real(1));
  }
  touch.surface_velocity = geom.velocity + geom.angular_velocity.cross(arm);
  return touch;
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
void Contact<Real>::ApplySurfaces(int i, const Vector& x, const std::vector<PlacedGeom>& geoms,
                                  Real h, Vector* velocity, std::vector<Touch>* touches) const {
  const auto apply = [&](Touch touch) {
    const Vector u = *velocity - touch.surface_velocity;
    const Real approach = touch.normal.dot(u);
    if (approach >= -Real(kApproach) || touch.gap - radius_[i] + h * approach >= 0) return;
    touch.velocity_before = *velocity;
    *velocity = touch.surface_velocity + Impact<Real>(u, touch.normal, laws_.surface);
    if (touches) touches->push_back(touch);
  };
  if (has_ground_) apply(GroundTouch(x));
  for (const PlacedGeom& geom : geoms) apply(GeomTouch(geom, x));
}

template <class Real>
void Contact<Real>::Apply(const NodeStates<Real>& state, const Pairs& pairs,
                          const std::vector<Geom>& geoms, double elapsed, double h,
                          Velocities* velocity) const {
  if (!pairs.empty()) ApplyPairs(state, pairs, velocity);
  const std::vector<PlacedGeom> placed = Place(geoms, elapsed);
  for (int i = 0; i < nodes_; ++i) {
    ApplySurfaces(i, X(state[i]), placed, static_cast<Real>(h), &(*velocity)[i], nullptr);
  }
}

template <class Real>
void Contact<Real>::ApplyAdjoint(const NodeStates<Real>& state, const Pairs& pairs,
                                 const std::vector<Geom>& geoms, double elapsed, double h,
                                 const Velocities& velocity, Velocities* velocity_bar,
                                 ContactGradient<Real>* gradient) const {
  Velocities after_pairs = velocity;
  if (!pairs.empty()) ApplyPairs(state, pairs, &after_pairs);
  const std::vector<PlacedGeom> placed = Place(geoms, elapsed);
  std::vector<Touch> touches;  // of one node
  for (int i = 0; i < nodes_; ++i) {
    touches.clear();
    ApplySurfaces(i, X(state[i]), placed, static_cast<Real>(h), &after_pairs[i], &touches);
    Vector& v_bar = (*velocity_bar)[i];
    for (auto touch = touches.rbegin(); touch != touches.rend(); ++touch) {
      // forward: v' = s + Impact(v - s, n)
      Vector u_bar = Vector::Zero(), n_bar = Vector::Zero();
      ImpactAdjoint<Real>(touch->velocity_before - touch->surface_velocity, touch->normal,
                          laws_.surface, v_bar, &u_bar, &n_bar, &gradient->laws.surface);
      if (touch->geom) {
        AddX(GeomTouchAdjoint(*touch->geom, X(state[i]), n_bar, v_bar - u_bar),
             &gradient->state[i]);
      }
      v_bar = u_bar;
    }
  }
  if (!pairs.empty()) {
    ApplyPairsAdjoint(state, pairs, velocity, velocity_bar, gradient);
  }
}

template class Contact<float>;
template class Contact<double>;

}  // namespace physpring
