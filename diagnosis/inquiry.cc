// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/inquiry.h"

#include <algorithm>
#include <cmath>

#include "twin/effects/registry.h"
#include "twin/effects/twist_section.h"

namespace physpring {
namespace {

constexpr int kDraws = 2000;
constexpr double kBlock = 0.2;  // s, a block of the bootstrap

// Whether frames to judge by lie between frames to fit.
bool IsJudgedInBetween(const SplitRecording& split) {
  const auto held = std::find(split.use.begin(), split.use.end(), SplitRecording::Use::kHeld);
  return std::find(held, split.use.end(), SplitRecording::Use::kFit) != split.use.end();
}

std::vector<const Effect*> EffectsFor(const std::vector<SplitRecording>& splits,
                                      const SpringMassSystem& body) {
  const bool ground = splits[0].recording->ground.has_value();
  const BodyTraits traits = {ground, IsSolid(body), HasTwistSections(body.rod, body.node_count())};
  const bool in_between = std::any_of(splits.begin(), splits.end(), IsJudgedInBetween);
  std::vector<const Effect*> effects;
  for (const Effect* effect : AllEffects()) {
    const bool has_it =
        std::any_of(body.effects.begin(), body.effects.end(),
                    [&](const EffectValues& own) { return own.name == effect->name(); });
    if (has_it || !effect->MayBeMissing(traits)) continue;
    if (CanBeJudged(effect->value_count(), in_between)) effects.push_back(effect);
  }
  return effects;
}

}  // namespace

int Inquiry::Block() const {
  return static_cast<int>(std::ceil(kBlock * fitting.recordings()[0].recording->fps));
}

BootstrapResult Inquiry::Gain(const FrameTrack& without, const FrameTrack& with) const {
  return BlockBootstrap(Difference(without, with), Block(), kDraws, options.seed);
}

Threshold Inquiry::ThresholdFor(std::size_t tried) const {
  return {noise_floor, options.false_alarm, options.least_gain, options.least_noise,
          static_cast<int>(tried)};
}

Inquiry InquiryOf(const Fitting& fitting, double noise_floor, const DiagnosisOptions& options) {
  return {fitting, noise_floor, options,
          EffectsFor(fitting.recordings(), fitting.bodies()[0].base)};
}

}  // namespace physpring
