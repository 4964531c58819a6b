// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/law_term.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace physpring {
namespace {

constexpr double kFewestFrames = 8;  // in a period

// Whether a wave is so slow that it stands for another course.
bool IsTooSlow(const Fitting& fitting, const EffectValues& effect) {
  const double slowest = 0.5 * SlowestRate(*fitting.recordings()[0].recording);
  return effect.name == kCustom &&
         effect.values[kCustomInTime] == static_cast<double>(InTime::kPeriodic) &&
         effect.values[kCustomRate] < slowest;
}

}  // namespace

int LawTerm::coefficient_count() const {
  return (acts_on >= ActsOn::kStretch ? 1 : 3) * (periodic() ? 2 : 1);
}

EffectValues LawTerm::With(const Eigen::VectorXd& coefficients) const {
  Eigen::VectorXd values = Eigen::VectorXd::Zero(kCustomValues);
  values[kCustomActsOn] = static_cast<double>(acts_on);
  values[kCustomInTime] = static_cast<double>(in_time);
  values[kCustomRate] = rate;
  const int each = acts_on >= ActsOn::kStretch ? 1 : 3;
  for (int i = 0; i < coefficients.size(); ++i) {
    values[i < each ? kCustomA + i : kCustomB + i - each] = coefficients[i];
  }
  return {kCustom, values};
}

double SlowestRate(const Recording& recording) {
  return std::numbers::pi * recording.fps / recording.frame_count();
}

std::vector<LawTerm> TermsOf(const LawTerm& kind, const Recording& recording) {
  if (!kind.periodic()) return {kind};
  const double slowest = SlowestRate(recording);
  const double fastest = 2 * std::numbers::pi * recording.fps / kFewestFrames;
  std::vector<LawTerm> terms;
  for (int n = 1; n * slowest < fastest; n += 2) {
    terms.push_back(kind);
    terms.back().rate = n * slowest;
  }
  return terms;
}

Descent WithoutSlowWaves(const Fitting& fitting, Descent fit) {
  const double middle = 0.5 * fitting.recordings()[0].recording->frame_count() /
                        fitting.recordings()[0].recording->fps;
  const std::vector<EffectValues> now = fitting.Model(fit.hypothesis).Apply(fit.x).effects;
  std::vector<EffectValues>& starts = fit.hypothesis.effects;
  Eigen::Index behind = 0;  // entries of x behind the effect's
  for (std::size_t n = 1; n <= starts.size(); ++n) {
    const EffectValues& effect = now[now.size() - n];
    const Eigen::Index size = effect.values.size();
    if (IsTooSlow(fitting, effect)) {
      Eigen::VectorXd constant = Eigen::VectorXd::Zero(size);
      constant[kCustomActsOn] = effect.values[kCustomActsOn];
      constant.segment<3>(kCustomA) =
          std::sin(effect.values[kCustomRate] * middle) * effect.values.segment<3>(kCustomA) +
          std::cos(effect.values[kCustomRate] * middle) * effect.values.segment<3>(kCustomB);
      starts[starts.size() - n].values = constant;
      fit.x.segment(fit.x.size() - behind - size, size).setZero();
    }
    behind += size;
  }
  return fit;
}

Descent WithoutTerm(Descent fit, std::size_t from_last) {
  std::vector<EffectValues>& effects = fit.hypothesis.effects;
  const auto term = effects.end() - 1 - static_cast<long>(from_last);
  Eigen::Index behind = 0;  // values of those behind it
  for (auto effect = term + 1; effect != effects.end(); ++effect) behind += effect->values.size();
  Eigen::VectorXd x(fit.x.size() - term->values.size());
  x << fit.x.head(x.size() - behind), fit.x.tail(behind);
  fit.x = x;
  effects.erase(term);
  return fit;
}

}  // namespace physpring
