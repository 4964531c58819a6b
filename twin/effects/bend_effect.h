// SPDX-License-Identifier: Apache-2.0
// Effects that act where the body bends: at each triple (a, b, c) a law gives a moment M from the
// bend and its rate; geometry and adjoint are the same for all.
//   p, q   from a to b, from b to c:   unit tangents s = p / |p|, t = q / |q|
//   bend   kappa = t - s               of length 2 sin(angle / 2), rad for small angles
//   force  -(d kappa / d x)^T M:   f_c = -G(q, M), f_a = -G(p, M), f_b = G(q, M) + G(p, M)
// with G(e, M) = (M - t (t . M)) / |e|. A bend of any other rate of work than M . kappa_dot
// would break the balance of forces; torques are balanced too, if M depends on kappa alone. About a
// controller that holds nothing there is no moment.
#ifndef PHYSPRING_TWIN_EFFECTS_BEND_EFFECT_H_
#define PHYSPRING_TWIN_EFFECTS_BEND_EFFECT_H_

#include <vector>

#include "twin/effects/bending_triples.h"
#include "twin/effects/effect.h"

namespace physpring {

// What the moment at a triple depends on, or the derivatives of a loss with respect to it.
struct Bend {
  Eigen::Vector3d bend = Eigen::Vector3d::Zero();     // kappa
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();     // how fast kappa changes, 1/s
  Eigen::Vector3d tangent = Eigen::Vector3d::Zero();  // s
};

// The law of one effect of bending with given values, on one system's triples.
class BendMoment {
 public:
  using Vector = Eigen::Vector3d;

  BendMoment(const SpringMassSystem& system, const Eigen::VectorXd& values)
      : values_(values), triples_(FindBendingTriples(system)) {}
  virtual ~BendMoment() = default;

  // Whether each triple has three internal variables.
  virtual bool has_internal() const { return false; }
  int internal_size() const { return has_internal() ? 3 * static_cast<int>(triples_.size()) : 0; }

  // The moment M [N m] at a triple; advances its internal variables z.
  virtual Vector Moment(int triple, const Bend& bend, double step, Vector* z) const = 0;
  // Adjoint: z before the sub-step; *z_bar in d loss / d z after, out before. Adds to the rest.
  virtual void MomentAdjoint(int triple, const Bend& bend, double step, const Vector& z,
                             const Vector& moment_bar, Vector* z_bar, Bend* bar,
                             Eigen::VectorXd* values_bar) const = 0;

  const std::vector<BendingTriple>& triples() const { return triples_; }

 protected:
  const Eigen::VectorXd values_;

 private:
  std::vector<BendingTriple> triples_;
};

// One of several laws that act on the same triples, and where its internal variables begin.
struct BendLaw {
  const BendMoment* moment;
  int internal;
};

// The forces of all laws at once (at least one): the geometry of a triple, which takes most of the
// time, is worked out once for all. See EffectForce.
void AddBendForces(const std::vector<BendLaw>& laws, const Instant& instant,
                   Eigen::Ref<Eigen::VectorXd> internal, Points* force);
// values_bar: of each law, d loss / d its values. Adds to them, x_bar and v_bar.
void AddBendForcesAdjoint(const std::vector<BendLaw>& laws, const Instant& instant,
                          const Eigen::Ref<const Eigen::VectorXd>& internal,
                          const Points& force_bar, Eigen::Ref<Eigen::VectorXd> internal_bar,
                          Points* x_bar, Points* v_bar,
                          const std::vector<Eigen::VectorXd*>& values_bar);

// Springs along the triples of `bound` that are as stiff (`stiffness` B, N m^2) and as damped
// (`damping`, N m^2 s) as moments B kappa / length.
void StiffenLikeBending(double stiffness, double damping, SpringMassSystem* bound);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_EFFECTS_BEND_EFFECT_H_
