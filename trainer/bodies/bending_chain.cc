// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/bending_chain.h"

#include <algorithm>
#include <cmath>

#include "trainer/bodies/spring_net.h"
#include "twin/effects/registry.h"
#include "twin/effects/twist_section.h"
#include "twin/topology.h"

namespace physpring {
namespace {

// A rod of length l begins to slip at the curvature kSlip / l.
constexpr double kSlip = 5;
// The rigidity that would matter to a rod of length l and weight m g is kRigidity m g l^2.
constexpr double kRigidity = 3e-3;
// Strands that stick and slip make a chain's motions rough: longer differences see its slopes. And
// so many of their coordinates, one after the other, are off alike: they count as one.
constexpr double kChainDifference = 1e-2, kAlike = 30;
constexpr double kSimpler = 0.9;  // it has a tenth of a net's parameters: a tie is its

bool Bends(const EffectValues& effect) { return GetEffect(effect.name).bends(); }

std::vector<const Effect*> EffectsOfRods(RodPart part) {
  std::vector<const Effect*> effects;
  for (const Effect* effect : AllEffects()) {
    if (effect->rod_part() == part) effects.push_back(effect);
  }
  return effects;
}

double FlexuralRigidity(const std::vector<EffectValues>& effects) {
  double sum = 0;
  for (const EffectValues& e : effects) sum += GetEffect(e.name).FlexuralRigidity(e.values);
  return sum;
}

// How many of them a body has.
int FittedEffects(const SpringMassSystem& system) {
  return static_cast<int>(std::count_if(
      system.effects.begin(), system.effects.end(),
      [](const EffectValues& e) { return GetEffect(e.name).rod_part() == RodPart::kFitted; }));
}

// How far a search moves moments of the fitted effects, by their parameters; all have one scale.
double MomentScale() {
  for (const Effect* effect : EffectsOfRods(RodPart::kFitted)) {
    for (const EffectParameter& parameter : effect->parameters()) {
      if (parameter.is_moment) return parameter.scale;
    }
  }
  return 1;
}

class BendingChainKind : public BodyKind {
 public:
  std::string Addition() const override { return " and bending"; }
  bool has_single_springs() const override { return false; }

  // Its own effects are fitted: the moments of its own shape in units of the one with which its
  // stiffness answers to the curvature where it slips. Its springs are all alike, and how they are
  // damped along it hardly matters: fitted, that would ask for all sub-steps there are.
  void Free(const SpringMassSystem& base, ParameterOptions* options) const override {
    options->free_effects = FittedEffects(base);
    options->length_classes = options->dashpots = false;
    const double moment = FlexuralRigidity(base.effects) * kSlip / RodLength(base.rod);
    options->moment_unit = moment / MomentScale();
  }

  // The first value of the effect that makes it stiff.
  int SearchedEffect(const Parameters& factors) const override {
    int entry = factors.effects();
    for (const Effect* effect : EffectsOfRods(RodPart::kFitted)) {
      if (effect->FlexuralRigidity(Eigen::VectorXd::Ones(effect->value_count())) > 0) break;
      entry += effect->value_count();
    }
    return entry;
  }

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
  const double length = RodLength(recording.rod);
  const double spacing = length / static_cast<double>(recording.rod.arc.size() - 1);
  const double gravity = recording.gravity.norm() > 0 ? recording.gravity.norm() : 9.81;
  const RodTraits rod = {
      .length = length,
      .spacing = spacing,
      .node_mass = recording.mass / static_cast<double>(recording.particle_count()),
      .flexural_rigidity = kRigidity * recording.mass * gravity * length * length,
      .slip_angle = kSlip,
      .twists = HasTwistSections(recording.rod, recording.particle_count())};
  std::vector<EffectValues> effects;
  for (const RodPart part : {RodPart::kGiven, RodPart::kFitted}) {
    for (const Effect* effect : EffectsOfRods(part)) {
      const Eigen::VectorXd start = effect->StartOfRod(rod);
      if (start.size() > 0) effects.push_back({effect->name(), start});
    }
  }
  return effects;
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
  if (!bends || system.rod.empty()) return false;
  const int nodes = system.node_count();
  const std::vector<std::array<int, 2>> chain = ChainSprings(system.rod, nodes);
  return std::all_of(system.springs.begin(), system.springs.end(), [&](const auto& spring) {
    const std::array<int, 2> sorted = {std::min(spring[0], spring[1]),
                                       std::max(spring[0], spring[1])};
    return sorted[1] >= nodes || std::binary_search(chain.begin(), chain.end(), sorted);
  });
}

}  // namespace physpring
