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
};

// Derivatives that the contacts of a sub-step add to. `state`: with respect to the positions (the x
// of each entry); `mass`: with respect to the nodes' masses.
template <class Real>
struct ContactGradient {
  NodeState<Real>* state;
  Real* mass;
  ContactLaws<Real> laws;
};

template <class Real>
class Contact {
 public:
  using Vector = Eigen::Matrix<Real, 3, 1>;
  using Velocities = std::vector<Vector>;
  using Pairs = std::vector<std::array<int, 2>>;

  // `ground` and the system's contact_radius decide about the ground. Particles that are closer
  // than the collision distance in the reference configuration, or joined by a spring, never
  // collide.
  Contact(const SpringMassSystem& system, const Environment& environment);

  // Takes over coefficients, radii and masses of a system of the same topology and the same
  // collision distance.
  void SetParameters(const SpringMassSystem& system);

  // Whether anything can collide when there are `geoms` geoms.
  bool Active(std::size_t geoms) const { return has_ground_ || distance_ > 0 || geoms > 0; }

  // Pairs of particles near enough to collide within the next frame (looked for once a frame).
  Pairs FindPairs(const NodeStates<Real>& state, double frame_time) const;

  // velocity <- velocity after all contacts of a sub-step of h seconds, at the positions of
  // `state`. The geoms stand at their poses `elapsed` seconds after the start of the frame.
  void Apply(const NodeStates<Real>& state, const Pairs& pairs, const std::vector<Geom>& geoms,
             double elapsed, double h, Velocities* velocity) const;

  // Adjoint: `velocity` before the contacts; velocity_bar: in d loss / d velocity after, out
  // before.
  void ApplyAdjoint(const NodeStates<Real>& state, const Pairs& pairs,
                    const std::vector<Geom>& geoms, double elapsed, double h,
                    const Velocities& velocity, Velocities* velocity_bar,
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
  // One impact of a node on the ground (geom = null) or a geom.
  struct Touch {
    Vector normal;
    Real gap;
    Vector surface_velocity = Vector::Zero();
    const PlacedGeom* geom = nullptr;
    Vector velocity_before;
  };
  static std::vector<PlacedGeom> Place(const std::vector<Geom>& geoms, double elapsed);
  // From the box of a geom to x, in the geom's axes; 0 along the axes within the box.
  static Vector Offset(const PlacedGeom& geom, const Vector& x);
  Touch GroundTouch(const Vector& x) const;
  static Touch GeomTouch(const PlacedGeom& geom, const Vector& x);
  // d loss / d x from the derivatives with respect to normal and surface velocity.
  static Vector GeomTouchAdjoint(const PlacedGeom& geom, const Vector& x, const Vector& normal_bar,
                                 const Vector& surface_velocity_bar);
  // Leads node i at x through its impacts with ground and geoms: changes its velocity and, unless
  // `touches` is null, appends each impact.
  void ApplySurfaces(int i, const Vector& x, const std::vector<PlacedGeom>& geoms, Real h,
                     Vector* velocity, std::vector<Touch>* touches) const;

  void ApplyPairs(const NodeStates<Real>& state, const Pairs& pairs, Velocities* velocity) const;
  void ApplyPairsAdjoint(const NodeStates<Real>& state, const Pairs& pairs,
                         const Velocities& velocity, Velocities* velocity_bar,
                         ContactGradient<Real>* gradient) const;
  std::vector<int> CountHits(const NodeStates<Real>& state, const Pairs& pairs,
                             const Velocities& velocity) const;
  bool PairHits(const NodeStates<Real>& state, const std::array<int, 2>& pair,
                const Velocities& velocity) const;

  int nodes_;
  bool has_ground_ = false;
  Vector ground_normal_ = Vector::Zero();
  Real ground_offset_ = 0;
  Real distance_ = 0;  // below which particles collide, m
  ContactLaws<Real> laws_;
  std::vector<Real> radius_, mass_;
  Pairs never_;  // sorted pairs (i < j) that never collide
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_CONTACT_H_
