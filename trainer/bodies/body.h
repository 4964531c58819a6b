// SPDX-License-Identifier: Apache-2.0
// A body that a fit may choose: which particles are joined, whether dashpots feel the controllers'
// velocity, the cone of friction, its effects; and of which kind it is. A kind says how such a body
// is fitted:
//   spring net     common factors, then single springs       (spring_net.cc)
//   hanging net    the same, with springs that are stretched in frame 0 (hanging_net.cc)
//   bending chain  common factors, among them the values of its own effects, then by free motions
//                  (bending_chain.cc)
// Whatever differs between kinds is asked of the kind.
#ifndef PHYSPRING_TRAINER_BODIES_BODY_H_
#define PHYSPRING_TRAINER_BODIES_BODY_H_

#include <limits>
#include <string>
#include <vector>

#include "trainer/bodies/parameters.h"
#include "trainer/solvers/levenberg_marquardt.h"
#include "twin/effects/effect_values.h"
#include "twin/recording.h"
#include "twin/spring_mass_system.h"

namespace physpring {

class BodyKind {
 public:
  virtual ~BodyKind() = default;

  // What Body::Label says of the kind after the number of neighbours.
  virtual std::string Addition() const = 0;
  // Whether each spring has values of its own; else the fit ends with free motions.
  virtual bool has_single_springs() const = 0;
  // Sets in the parameters' options what is free in a system `base` of this kind.
  virtual void Free(const SpringMassSystem& base, ParameterOptions* options) const = 0;
  // The entry of the common factors, among those of effects, that a search of start values tries
  // several values of; -1: none.
  virtual int SearchedEffect(const Parameters& factors) const = 0;
  // The options with which common factors are fitted.
  virtual LevenbergMarquardtOptions FactorOptions(const Recording& recording) const = 0;
  // What a choice multiplies the error of such a body by. It lets a body of few values win ties.
  virtual double handicap() const = 0;
};

struct Body {
  static constexpr double kNowhere = std::numeric_limits<double>::infinity();
  const BodyKind* kind;
  int neighbours = 0;  // about so many springs join an inner particle to others
  double radius = 0;   // m, the search radius that gives so many (not used along rods)
  bool controller_velocity = true;
  FrictionCone cone = FrictionCone::kElliptic;
  std::vector<EffectValues> effects = {};  // the known ones, then the kind's own
  Eigen::VectorXd mass = {};               // each particle's mass, kg; empty: all alike
  Eigen::VectorXd strain = {};    // (springs) shares of the strain in frame 0; empty: stress-free
  double stretch = 0;             // the largest strain in frame 0
  double soft_beyond = kNowhere;  // m: springs that are longer begin soft in a smooth body
  bool braced_joints = true;      // those of a rod with branches keep their shape (topology.h)

  std::string Label() const;
};

// The softest and the stiffest start system that a fit tries, in sub-steps a frame.
constexpr double kSoftestStart = 2, kStiffestStart = 64;

// The body with springs to half as many neighbours more, which begin soft. In an irregular mesh
// there is no gap between shells: a radius that leaves out true springs is not told from others,
// and without them no fit arrives. Nothing changes along a rod or in a net that hangs.
Body WithSoftSprings(const Body& body, const Recording& recording);

// The system that a fit of `body` starts from. It is over-damped, and as soft as `start_substeps`
// sub-steps a frame allow. Throws Error where the recording gives no body.
SpringMassSystem StartSystem(const Recording& recording, const Body& body, double start_substeps);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_BODIES_BODY_H_
