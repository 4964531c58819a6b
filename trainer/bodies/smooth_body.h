// SPDX-License-Identifier: Apache-2.0
// A spring net as a material: few numbers say how stiff and how lossy its springs are, and none is
// of a single spring. They are those of parameters.h:
//   global      stiffness, loss time (dashpot / stiffness), drag, contact, effects
//   classes     the stiffness of springs of one length, and of a hand's
//   one field   even slopes and some modes of stiffness along the body (spring_modes.h)
// Single springs bend to one motion, and then predict no other one. These numbers do not: of bodies
// that are networks they find the true ones (docs/decisions/111-smooth-bodies.md).
#ifndef PHYSPRING_TRAINER_BODIES_SMOOTH_BODY_H_
#define PHYSPRING_TRAINER_BODIES_SMOOTH_BODY_H_

#include <limits>

#include "trainer/bodies/body.h"
#include "trainer/bodies/parameters.h"
#include "twin/spring_mass_system.h"
#include "twin/stability.h"

namespace physpring {

struct FieldModes;

class SmoothBody {
 public:
  enum class Numbers { kAll, kFew };  // few modes: for a search among many bodies
  // The prior's standard deviations: of the field's smoothest mode; of each class of length; and of
  // how springs of controllers differ from the object's, in stiffness, in loss time, and by rank.
  struct Widths {
    double field = 0.5, classes = 2, hands = std::numeric_limits<double>::infinity();
    bool operator==(const Widths&) const = default;
  };
  struct Options {
    double most_rate;          // the most sub-steps a second; whole ones a frame, at least one
    bool hands_apart = false;  // springs of controllers are in classes apart (spring_classes.h)
    bool directions = false;   // so are springs of other directions
    Numbers numbers = Numbers::kAll;
    bool class_loss_times = false;         // each class has a loss time of its own
    SpringClassOptions::Finer finer = {};  // classes of long springs in an irregular mesh
    Widths widths = {};
  };

  // `start`: the system at x = 0, whose springs have one loss time.
  SmoothBody(const SpringMassSystem& start, const Recording& recording, const BodyKind& kind,
             const Options& options);

  int size() const { return factors_.size(); }
  const Parameters& factors() const { return factors_; }
  const Options& options() const { return options_; }
  void SetWidths(const Widths& widths) { options_.widths = widths; }
  double most_rate() const { return options_.most_rate; }
  bool hands_apart() const { return options_.hands_apart; }
  bool directions() const { return options_.directions; }
  // The prior's precision near x. The field has the prior of a thin plate's deflection (Wahba,
  // Spline Models for Observational Data, 1990, ch. 2): the rougher a mode, the smaller it is held,
  // and even slopes as little as ever; few modes are all smooth, and held alike.
  // Classes whose springs are much alike (spring_classes.h) are about as stiff, but for a few
  // jumps: their differences have a Laplace distribution, as the normal one that is as steep at x
  // (iteratively reweighted least squares).
  Eigen::MatrixXd Precision(const Eigen::VectorXd& x) const;

  // Where the system would need more sub-steps than that, its dashpots are lowered by one factor,
  // and where that is not enough, its stiffnesses: a fit that could not go there would be stuck.
  SpringMassSystem Apply(const Eigen::VectorXd& x) const;
  bool IsLimited(const Eigen::VectorXd& x) const;  // whether Apply lowers anything

  // A body of this kind that is most like `system`, which has the same springs: their stiffnesses
  // by least squares of logarithms, in which stiff springs weigh more; its loss time, drag and
  // contact; rest lengths of the start.
  SpringMassSystem NearestTo(const SpringMassSystem& system) const;

  // Numbers that make the body's springs most like those of `system`, in the same sense, and their
  // loss times as long; else, as drag and contact, those of `x`, of a body of this kind of other
  // springs.
  Eigen::VectorXd NumbersLike(const SpringMassSystem& system, const Eigen::VectorXd& x) const;

 private:
  Eigen::VectorXd NearestStiffnesses(const SpringMassSystem& system) const;
  SmoothBody(const SpringMassSystem& start, const Recording& recording, const BodyKind& kind,
             const Options& options, const FieldModes& modes);

  // s: what must be stable. A little above the shortest sub-step, so that rounding needs no more.
  double timestep() const { return 1.001 / (options_.most_rate * kStepSafety); }

  Parameters factors_;
  Eigen::VectorXd roughness_;  // of the field's modes, by which the prior holds them
  Options options_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_BODIES_SMOOTH_BODY_H_
