// SPDX-License-Identifier: Apache-2.0
// A term of a law, as it is looked for: the effect `custom` (twin/effects/custom.h) without its
// coefficients. Those enter the forces linearly.
#ifndef PHYSPRING_DIAGNOSIS_LAW_TERM_H_
#define PHYSPRING_DIAGNOSIS_LAW_TERM_H_

#include <array>
#include <vector>

#include "diagnosis/fitting.h"
#include "twin/effects/custom.h"
#include "twin/effects/effect_values.h"
#include "twin/recording.h"

namespace physpring {

struct LawTerm {
  ActsOn acts_on = ActsOn::kNode;
  InTime in_time = InTime::kConstant;
  double step = 0;  // of a coefficient, whose response is well above rounding
  double rate = 0;  // rad/s, of a wave

  bool periodic() const { return in_time == InTime::kPeriodic; }
  int coefficient_count() const;
  EffectValues With(const Eigen::VectorXd& coefficients) const;  // those behind count as 0
};

// Those that are not an effect of the list already, as a constant acceleration is.
inline constexpr std::array<LawTerm, 11> kLawLibrary = {{
    {ActsOn::kNode, InTime::kGrowing, 0.1},
    {ActsOn::kNode, InTime::kSquare, 0.1},
    {ActsOn::kNode, InTime::kPeriodic, 0.1},
    {ActsOn::kPlace, InTime::kConstant, 1},
    {ActsOn::kPlace, InTime::kSquare, 1},
    {ActsOn::kPlace, InTime::kPeriodic, 1},
    {ActsOn::kVelocity, InTime::kConstant, 0.1},
    {ActsOn::kVelocity, InTime::kPeriodic, 0.1},
    {ActsOn::kStretch, InTime::kSquare, 0.01},
    {ActsOn::kStretch, InTime::kPeriodic, 0.01},
    {ActsOn::kSquare, InTime::kConstant, 0.1},
}};

// The terms of a kind: a wave with every second of the frequencies n SlowestRate.
std::vector<LawTerm> TermsOf(const LawTerm& kind, const Recording& recording);

// The lowest frequency that is tried, rad/s: half a period in the recording. Others are as far
// apart: at twice that distance a wave is of the wrong sign at one end.
double SlowestRate(const Recording& recording);

// The fit with constant terms in place of waves that are so slow that they stand for another
// course: what they degenerate to.
Descent WithoutSlowWaves(const Fitting& fitting, Descent fit);

// The fit without one of its last effects, `from_last` before the last one.
Descent WithoutTerm(Descent fit, std::size_t from_last);

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_LAW_TERM_H_
