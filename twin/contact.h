// SPDX-License-Identifier: Apache-2.0
// Contacts of a twin's nodes with each other, with the ground and with moving geoms: where the
// contact law (contact_law.h) acts, and with which normal. One call handles one sub-step, all
// nodes, in this order: pairs of particles (all at once, as PhysTwin: Jacobi), then each node with
// the ground and with the geoms one after the other.
#ifndef PHYSPRING_TWIN_CONTACT_H_
#define PHYSPRING_TWIN_CONTACT_H_

#include <array>
#include <vector>

#include "twin/contact_law.h"
#include "twin/environment.h"
#include "twin/node_state.h"
#include "twin/spring_mass_system.h"

namespace physpring {

template <class Real>
struct ContactLaws {
  ContactPair<Real> surface;  // ground and geoms
  ContactPair<Real> object;   // between particles

  // Adds derivatives with respect to the coefficients.
  template <class Other>
  ContactLaws& operator+=(const ContactLaws<Other>& bar) {
    surface += bar.surface;
    object += bar.object;
    return *this;
  }
};

// The laws with the coefficients of a level.
template <class Real>
ContactLaws<Real> LawsOf(const ContactCoefficients& c) {
  return {c.surface.To<Real>(), c.object.To<Real>()};
}

// Derivatives that the contacts of a sub-step add to, besides those with respect to the state.
template <class Real>
struct ContactGradient {
  std::vector<Real> mass;  // (nodes)
  ContactLaws<Real> laws;
};

template <class Real>
class Contact {
 public:
  using Vector = Eigen::Matrix<Real, 3, 1>;
  using Pairs = std::vector<std::array<int, 2>>;

  // The impacts of a sub-step: what its adjoint needs. Kept from sub-step to sub-step, it allocates
  // no memory unless there are more impacts than ever before.
  class Impacts;

  // `ground` and the system's contact_radius decide about the ground. Particles that are closer
  // than the collision distance in the reference configuration, or joined by a spring, never
  // collide.
  Contact(const SpringMassSystem& system, const Environment& environment);

  // Takes over coefficients, radii and masses of a system of the same topology and the same
  // collision distance.
  void SetParameters(const SpringMassSystem& system);

  // Pairs of particles near enough to collide within the next frame (looked for once a frame).
  Pairs FindPairs(const NodeStates<Real>& state, double frame_time) const;

  // The velocities of `next` <- those after all contacts of a sub-step of h seconds, at the
  // positions of `state`. The geoms stand at their poses `elapsed` seconds after the start of the
  // frame.
  void Apply(const NodeStates<Real>& state, const Pairs& pairs, const std::vector<Geom>& geoms,
             double elapsed, double h, NodeStates<Real>* next, Impacts* impacts) const;

  // The parts of this, for rollouts whose ground is looked at side by side: the plane (offset:
  // normal . x on it, m; tangents of the pyramidal cone), how near it the nodes touch it, and the
  // law.
  bool has_ground() const { return has_ground_; }
  const Vector& ground_normal() const { return ground_normal_; }
  Real ground_offset() const { return ground_offset_; }
  const std::vector<Real>& radius() const { return radius_; }  // m
  const Tangents<Real>& ground_tangents() const { return ground_tangents_; }
  const ContactPair<Real>& surface_law() const { return laws_.surface; }

  // Makes the velocities of `next` those before the contacts again.
  void Undo(const Impacts& impacts, NodeStates<Real>* next) const;

  // Adjoint. The velocities of state_bar: in d loss / d velocity after, out before; its positions:
  // adds d loss / d position.
  void ApplyAdjoint(const NodeStates<Real>& state, Impacts* impacts, NodeStates<Real>* state_bar,
                    ContactGradient<Real>* gradient) const;

 private:
  // A geom where it stands in a sub-step.
  struct PlacedGeom {
    Vector half_size;
    Real radius;
    Vector position;
    Eigen::Matrix<Real, 3, 3> rotation;
    Vector velocity, angular_velocity;
  };
  // One impact of a node on the ground or a geom.
  struct Touch {
    int node;
    int geom;  // index in Impacts; -1 = ground
    Vector normal = Vector::Zero();
    Vector surface_velocity = Vector::Zero();
    Vector velocity_before = Vector::Zero();
  };
  // One impact of two particles.
  struct Collision {
    int a, b;
    Vector u;      // v_b - v_a before
    Vector u_bar;  // d loss / d u, of the adjoint
  };
  struct Velocity {
    int node;
    Vector v;
  };

  static PlacedGeom Place(const Geom& geom, double elapsed);
  // From the box of a geom to x, in the geom's axes; 0 along the axes within the box.
  static Vector Offset(const PlacedGeom& geom, const Vector& x);
  // Normal and velocity of the surface of a geom that is nearest to x, and the distance from it.
  static Real Gap(const PlacedGeom& geom, const Vector& x, Touch* touch);
  // d loss / d x from the derivatives with respect to normal and surface velocity.
  static Vector GeomTouchAdjoint(const PlacedGeom& geom, const Vector& x, const Vector& normal_bar,
                                 const Vector& surface_velocity_bar);
  bool Hits(int node, Real gap, Real approach, Real h) const;
  Vector After(const Touch& touch) const;
  void ApplyTouch(Touch touch, NodeStates<Real>* next, Impacts* impacts) const;
  void ApplyGround(const NodeStates<Real>& state, Real h, NodeStates<Real>* next,
                   Impacts* impacts) const;
  void ApplyGeoms(const NodeStates<Real>& state, Real h, NodeStates<Real>* next,
                  Impacts* impacts) const;
  void ApplyTouchAdjoint(const NodeStates<Real>& state, const Impacts& impacts, const Touch& touch,
                         NodeStates<Real>* state_bar, ContactGradient<Real>* gradient) const;

  void ApplyPairs(const NodeStates<Real>& state, const Pairs& pairs, NodeStates<Real>* next,
                  Impacts* impacts) const;
  void ApplyPairsAdjoint(const NodeStates<Real>& state, Impacts* impacts,
                         NodeStates<Real>* state_bar, ContactGradient<Real>* gradient) const;

  int nodes_;
  bool has_ground_ = false;
  Vector ground_normal_ = Vector::UnitZ();
  Tangents<Real> ground_tangents_{ground_normal_};
  Real ground_offset_ = 0;
  Real distance_ = 0;  // below which particles collide, m
  ContactLaws<Real> laws_;
  std::vector<Real> radius_, mass_;
  Pairs never_;  // sorted pairs (i < j) that never collide
};

template <class Real>
class Contact<Real>::Impacts {
  friend class Contact;
  std::vector<PlacedGeom> geoms;
  std::vector<Collision> collisions;
  std::vector<int> hits;  // how often each node is hit by other particles
  std::vector<Touch> touches;
  std::vector<Velocity> before;  // the velocities of the nodes that particles hit
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_CONTACT_H_
