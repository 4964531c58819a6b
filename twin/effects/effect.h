// SPDX-License-Identifier: Apache-2.0
// An effect: a piece of physics that a spring-mass system may have besides its springs, its drag
// and its contacts. A system names its effects with their values (spring_mass_system.h); what the
// values mean is said here, once for each effect, in a file of its own. An effect may
//   change the setting before the simulation (masses, rest lengths, gravity, contact coefficients),
//   delay the controllers' motion,
//   add forces on the nodes in each sub-step, from positions, velocities, time and internal
//   variables of its own, which start at 0 and are part of the simulator's state,
//   add tension to the springs in each sub-step, in the same way (spring_tension.h),
//   add moments where the body bends, in the same way (bend_effect.h).
// Each has its adjoint. Values of 0 change nothing. Forces on nodes are computed in double
// precision also where the simulator is not. twin/effects/list.h lists the effects.
#ifndef PHYSPRING_TWIN_EFFECTS_EFFECT_H_
#define PHYSPRING_TWIN_EFFECTS_EFFECT_H_

#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "twin/controller_mask.h"
#include "twin/effects/effect_mjcf.h"
#include "twin/effects/effect_picture.h"
#include "twin/effects/spring_tension.h"
#include "twin/spring_mass_system.h"
#include "twin/system_gradient.h"

namespace physpring {

class BendMoment;

// A parameter of an effect: one value, or several of a kind, one after the other.
struct EffectParameter {
  enum class Spacing { kEven, kLogarithmic };  // how a search moves it
  std::string key;                             // with the unit: "mass_kg"
  double low, high;                            // bounds of each value
  double scale;                                // a change that matters; if logarithmic a factor e
  int count = 1;
  Spacing spacing = Spacing::kEven;
  bool is_moment = false;  // in a rod a search moves it by the moments that bend that rod
  // Nothing is beyond its bounds, as of a share, or it is the same effect there.
  bool bounds_are_natural = false;
};

// Whether a value is at a bound of its parameter beyond which the truth may lie: one that is
// neither natural nor a "not at all".
bool IsAtBound(const EffectParameter& parameter, double value);

// What an effect may change before a simulation.
struct Setting {
  SpringMassSystem system;
  Eigen::Vector3d gravity;  // m/s^2
};

// What decides whether a body may lack an effect.
struct BodyTraits {
  bool on_ground;  // there is a ground
  bool solid;      // its springs spread in all three directions
  bool twists;     // it is a rod with sections that are twisted (twist_section.h)
};

// A rod with which a fit starts.
struct RodTraits {
  double length, spacing;    // m, the whole and between nodes
  double node_mass;          // kg
  double flexural_rigidity;  // N m^2, that would matter to it under its own weight
  double slip_angle;         // rad, by which it is bent in all where its strands begin to slip
  bool twists;               // it has sections that are twisted (twist_section.h)
};

// Whether every rod has an effect, and whether a fit changes its values.
enum class RodPart { kNone, kGiven, kFitted };

// The sub-step in which forces act.
struct Instant {
  double time;      // s since the start of the recording
  double step;      // length of the sub-step, s
  const Points& x;  // 3 x (nodes + controllers), m
  const Points& v;  // m/s
  const ControllerMask& released;

  // Whether a column of x is a controller that holds nothing.
  bool IsReleased(int column) const {
    const int controller = column - static_cast<int>(x.cols() - std::ssize(released));
    return !released.empty() && controller >= 0 && Has(released, controller);
  }
};

// Where the adjoint of forces adds d loss / d what the forces depend on.
struct InstantGradient {
  Points x, v;                 // 3 x (nodes + controllers)
  Eigen::VectorXd values;      // with respect to the effect's values
  SystemGradient* parameters;  // with respect to the system's numbers
};

// The forces on nodes of one effect with given values on one system, which must outlive it.
class EffectForce {
 public:
  virtual ~EffectForce() = default;

  // How many internal variables there are.
  virtual int internal_size() const { return 0; }

  // Adds the forces [N] on nodes (and on controllers, where they do nothing) to `force`, and
  // advances the internal variables by the sub-step.
  virtual void Add(const Instant& instant, Eigen::Ref<Eigen::VectorXd> internal,
                   Points* force) const = 0;

  // Adjoint of Add. `internal`: the variables before it. `internal_bar`: in d loss / d variables
  // after, out before. Adds to `gradient`.
  virtual void AddAdjoint(const Instant& instant, const Eigen::Ref<const Eigen::VectorXd>& internal,
                          const Points& force_bar, Eigen::Ref<Eigen::VectorXd> internal_bar,
                          InstantGradient* gradient) const = 0;
};

class Effect {
 public:
  virtual ~Effect() = default;

  virtual std::string name() const = 0;
  virtual std::vector<EffectParameter> parameters() const = 0;

  // Values from which a search on `system` begins: one or more of them, each near to no effect or
  // of a usual size.
  virtual std::vector<Eigen::VectorXd> Starts(const SpringMassSystem& system) const = 0;

  // Before the simulation. Adjoint: `gradient`, in d loss / d the changed setting, out d loss / d
  // `before`; adds to values_bar.
  virtual void Change(const Eigen::VectorXd& values, Setting* setting) const;
  virtual void ChangeAdjoint(const Eigen::VectorXd& values, const Setting& before,
                             SystemGradient* gradient, Eigen::VectorXd* values_bar) const;

  // Whether it is about bending, which in a solid its springs account for.
  virtual bool bends() const { return false; }

  // Whether a body like this may lack it.
  virtual bool MayBeMissing(const BodyTraits& body) const { return !(body.solid && bends()); }

  virtual RodPart rod_part() const { return RodPart::kNone; }
  // Values with which a rod starts, if it has the effect; none: it does not.
  virtual Eigen::VectorXd StartOfRod(const RodTraits& rod) const;
  // The flexural rigidity that is added to a rod, N m^2.
  virtual double FlexuralRigidity(const Eigen::VectorXd& values) const;

  // How much later than recorded the controllers move, s. If `delays`, it is the first value.
  virtual bool delays() const { return false; }

  // Nothing if the effect has no forces of its own on nodes.
  virtual std::unique_ptr<EffectForce> MakeForce(const SpringMassSystem& system,
                                                 const Eigen::VectorXd& values) const;
  // Nothing if the effect does not act along the springs.
  virtual std::unique_ptr<SpringTension> MakeTension(const Eigen::VectorXd& values) const;
  // Nothing if the effect does not act where the body bends.
  virtual std::unique_ptr<BendMoment> MakeBend(const SpringMassSystem& system,
                                               const Eigen::VectorXd& values) const;
  // Whether it has one of the three.
  bool HasForces(const SpringMassSystem& system, const Eigen::VectorXd& values) const;

  // Makes the springs of `bound` so stiff, or adds springs to it, that the sub-steps that are
  // stable for it are stable for the system with the effect (twin/stability.h).
  virtual void Stiffen(const Eigen::VectorXd& values, SpringMassSystem* bound) const;

  // What stands for the effect in MuJoCo. The changed setting is exported by itself.
  virtual EffectMjcf Mjcf(const Eigen::VectorXd& values, const SpringMassSystem& system) const = 0;

  // What a page says and shows of it; `before`: the setting that it changes. By default its name
  // alone.
  virtual EffectPicture Picture(const Eigen::VectorXd& values, const Setting& before) const;

  int value_count() const;
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_EFFECTS_EFFECT_H_
