// SPDX-License-Identifier: Apache-2.0
// The effects that a diagnosis found, in words of people: how much of them, how surely, and where.
#ifndef PHYSPRING_REPORT_DIAGNOSIS_EFFECT_WORDS_H_
#define PHYSPRING_REPORT_DIAGNOSIS_EFFECT_WORDS_H_

#include <optional>
#include <string>
#include <vector>

#include "diagnosis/diagnosis.h"
#include "twin/effects/effect_picture.h"

namespace physpring {

// A value of an effect with its 95 % interval, which ends at the value's bounds.
struct ValueRange {
  std::string key;    // of its parameter
  std::string label;  // "place x", or "strain 3" where there are several
  std::string unit;
  double value, low, high;
  std::optional<ValueCertainty> certainty;  // none: not known, and low = high = value
  bool at_bound = false;                    // of what was searched, where that is no "not at all"
};

// Of the effect with that index.
std::vector<ValueRange> RangesOf(const Diagnosis& diagnosis, std::size_t effect);
EffectPicture PictureOf(const Diagnosis& diagnosis, const EffectValues& effect);

// "tension only" of "tension_only".
std::string SpacedName(const std::string& name);

// "near the free end", "in the middle", ...; empty if the body has no ends.
std::string DescribePlace(const SpringMassSystem& system, const Eigen::Vector3d& place);

// "an extra mass of about 19.6 g (18.3 to 20.9 g) near the free end".
std::string DescribeEffect(const Diagnosis& diagnosis, std::size_t effect);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_DIAGNOSIS_EFFECT_WORDS_H_
