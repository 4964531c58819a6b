// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/bending_chain.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "trainer/bodies/spring_net.h"
#include "twin/effects/registry.h"

namespace physpring {
namespace {

// Where the curvature of a rod of length l that slips begins to matter, kSlip / l.
constexpr double kSlip = 5;
// The rigidity that would matter to a rod of length l and weight m g is kRigidity m g l^2; friction
// holds kFriction of its moment at the curvature where it slips.
constexpr double kRigidity = 3e-3, kFriction = 0.3;
// A little damping, which is not fitted, calms the shortest waves at this rate, 1/s; more of it
// would serve fits under an observer, but not free motions.
constexpr double kCalm = 100;
// Strands that stick and slip make a chain's motions rough: longer differences see its slopes. And
// so many of their coordinates, one after the other, are off alike: they count as one.
constexpr double kChainDifference = 1e-2, kAlike = 30;
constexpr double kSimpler = 0.9;  // it has a tenth of a net's parameters: a tie is its
constexpr int kFitted = 4;        // effects, the last ones of a chain, are fitted

double RodLength(const Eigen::VectorXd& order) { return order.maxCoeff() - order.minCoeff(); }

bool Bends(const EffectValues& effect) { return GetEffect(effect.name).bends(); }

class BendingChainKind : public BodyKind {
 public:
  std::string Addition() const override { return " and bending"; }
  bool has_single_springs() const override { return false; }

  // Its own effects are fitted: the moments of its own shape in units of the one with which its
  // stiffness answers to the curvature where it slips. Its springs are all alike, and how they are
  // damped along it hardly matters: fitted, that would ask for all sub-steps there are.
  void Free(const SpringMassSystem& base, ParameterOptions* options) const override {
    options->free_effects = kFitted;
    options->length_classes = options->dashpots = false;
    const EffectValues& bending = *(base.effects.end() - kFitted);
    const double moment = bending.values[0] * kSlip / RodLength(base.order);
    options->moment_unit = moment / GetEffect("rest_bend").parameters()[0].scale;
  }

  // The rigidity, the first value.
  int SearchedEffect(const Parameters& factors) const override { return factors.effects(); }

  LevenbergMarquardtOptions FactorOptions(const Recording& /*recording*/) const override {
    LevenbergMarquardtOptions options;
    options.difference = kChainDifference;
    options.precision *= kAlike;
    return options;
  }
  double handicap() const override { return kSimpler; }
};

// The effects of a chain at their start: first those that stay, then those that are fitted.
std::vector<EffectValues> StartEffects(const Recording& recording) {
  const double length = RodLength(recording.order);
  const double spacing = length / static_cast<double>(recording.order.size() - 1);
  const double gravity = recording.gravity.norm() > 0 ? recording.gravity.norm() : 9.81;
  const double rigidity = kRigidity * recording.mass * gravity * length * length;
  const double friction = kFriction * rigidity * kSlip / length;
  // of an even chain of nodes of mass m at distances l: 16 D / (m l^3)
  const double node_mass = recording.mass / static_cast<double>(recording.particle_count());
  const double damping = kCalm * node_mass * std::pow(spacing, 3) / 16;
  return {{"bending_damping", Eigen::VectorXd::Constant(1, damping)},
          {"bending", Eigen::VectorXd::Constant(1, rigidity)},
          {"bending_friction", Eigen::Vector2d(friction, kSlip / length)},
          {"rest_bend", Eigen::VectorXd::Zero(GetEffect("rest_bend").value_count())},
          {"twist", Eigen::Vector2d(rigidity, 0)}};
}

}  // namespace

Body BendingChain(const Recording& recording, Body body) {
  static const BendingChainKind kind;
  body.neighbours = 2;
  if (std::any_of(body.effects.begin(), body.effects.end(), Bends)) return body;
  const std::vector<EffectValues> own = StartEffects(recording);
  body.effects.insert(body.effects.end(), own.begin(), own.end());
  body.kind = &kind;
  return body;
}

bool IsBendingChain(const SpringMassSystem& system) {
  const bool bends = std::any_of(system.effects.begin(), system.effects.end(), Bends);
  if (!bends || system.order.size() == 0) return false;
  const int nodes = system.node_count();
  std::vector<int> along(nodes), place(nodes);
  std::iota(along.begin(), along.end(), 0);
  std::sort(along.begin(), along.end(),
            [&](int i, int j) { return system.order[i] < system.order[j]; });
  for (int i = 0; i < nodes; ++i) place[along[i]] = i;
  return std::all_of(system.springs.begin(), system.springs.end(), [&](const auto& spring) {
    const bool controlled = std::max(spring[0], spring[1]) >= nodes;
    return controlled || std::abs(place[spring[0]] - place[spring[1]]) == 1;
  });
}

}  // namespace physpring
