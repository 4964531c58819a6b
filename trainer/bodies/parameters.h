// SPDX-License-Identifier: Apache-2.0
// What training moves: an unconstrained vector, and the map from it to a spring-mass system.
//   stiffness_e   = base_e exp(global + class(e) + field(e) + own_e)
//   dashpot_e     = base_e exp(global + class(e) + own_e); with loss times (dashpot / stiffness)
//   for
//                   dashpots, times stiffness_e / base stiffness_e, too
//   rest_length_e = base_e exp(own_e); in a hanging net (hanging_net.h) the strains of all springs
//                   in the base's positions have a factor exp(stretch), too
//   drag          = base exp(.)
//   coefficients of the contact with the ground: contact_logits.h
//   values of the base's last effects: effect_entries.h
// Zero is the base system. Springs of about the same rest length are one class (spring_classes.h).
// The `own` parts are deviations of single springs, held small by the prior. The field is a sum of
// modes, smooth along the body (spring_modes.h).
#ifndef PHYSPRING_TRAINER_BODIES_PARAMETERS_H_
#define PHYSPRING_TRAINER_BODIES_PARAMETERS_H_

#include <vector>

#include "trainer/bodies/effect_entries.h"
#include "trainer/bodies/spring_classes.h"
#include "twin/simulator.h"
#include "twin/spring_mass_system.h"

namespace physpring {

struct ParameterOptions {
  bool spring_stiffness = true;  // single springs, else one factor for all
  bool spring_dashpot = true;    // single dashpots, else one factor for all
  bool spring_rest_length = false;
  bool contact = false;        // coefficients of the contact with the ground
  int free_effects = 0;        // so many of the base's effects, the last ones; the others stay
  double moment_unit = 1;      // of those that are moments (effect_entries.h)
  bool length_classes = true;  // else all springs are of one class
  bool class_dashpots = true;  // dashpots of length classes, else one factor for all
  bool dashpots = true;        // else none moves, and the entries of dashpots do nothing
  bool stretch = false;        // a factor for the strains of the base in its own positions
  bool loss_times = false;     // dashpots follow the stiffnesses; their entries are of loss times
  SpringClassOptions classes = {};
  // springs x modes: what the field of stiffness is made of; empty: there is none
  Eigen::MatrixXd modes = {};
};

class Parameters {
 public:
  Parameters(const SpringMassSystem& base, const ParameterOptions& options);

  int size() const { return size_; }
  const SpringMassSystem& base() const { return base_; }
  // What each entry is: global (stiffnesses of classes and effects' values, too), a class's
  // dashpot, a mode of the field, or a spring's own stiffness, dashpot or rest length.
  enum class Kind { kGlobal, kClassDashpot, kMode, kStiffness, kDashpot, kRestLength };
  Kind kind(int i) const;
  // The entries of one value for the whole body: not of classes, single springs, or values of
  // effects along the body, and none that does nothing.
  std::vector<int> WholeBodyEntries() const;
  // The entries of effects' values along the body.
  std::vector<int> AlongBodyEntries() const;
  // The first entry of the classes' stiffnesses.
  int first_class() const { return first_class_; }
  // The first entry of the field's modes, if there are any.
  int first_mode() const { return modes_at_; }
  const SpringClasses& classes() const { return classes_; }
  // The entry of the ground's friction; -1: none.
  int friction() const;
  // The first entry of the effects' values, and how many there are.
  int effects() const { return effects_at_; }
  int effect_count() const { return effects_.size(); }

  SpringMassSystem Apply(const Eigen::VectorXd& values) const;

  // d loss / d values, from the derivatives with respect to `system`, which is Apply(values).
  Eigen::VectorXd Adjoint(const Eigen::VectorXd& values, const SpringMassSystem& system,
                          const SystemGradient& gradient) const;

 private:
  double LengthInBase(int e) const;
  double StrainInBase(int e) const;
  int ClassStiffness(int e) const { return first_class_ + classes_.of_spring[e]; }
  int mode_count() const { return static_cast<int>(options_.modes.cols()); }
  // -1: none
  int ClassDashpot(int e) const {
    return options_.class_dashpots ? ClassStiffness(e) + classes_.count : -1;
  }

  SpringMassSystem base_;
  ParameterOptions options_;
  EffectEntries effects_;  // those that are free
  int springs_;
  SpringClasses classes_;
  int first_class_;                                       // offset of the classes' stiffness and,
                                                          // after it, of their dashpot, if any
  int modes_at_;                                          // offset of the field's modes
  int effects_at_;                                        // offset of the effects' values
  int stretch_ = -1;                                      // offset of the stretch; -1: none
  int stiffness_ = -1, dashpot_ = -1, rest_length_ = -1;  // offsets of the own parts; -1: none
  int size_;
  // offsets of the global parts; those of contact only where wanted
  static constexpr int kStiffness = 0, kControllerStiffness = 1, kDashpot = 2,
                       kControllerDashpot = 3, kDrag = 4, kContact = 5;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_BODIES_PARAMETERS_H_
