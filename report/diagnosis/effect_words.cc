// SPDX-License-Identifier: Apache-2.0
#include "report/diagnosis/effect_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/picture/quantity.h"
#include "twin/effects/body_coordinate.h"
#include "twin/effects/registry.h"

namespace physpring {
namespace {

ValueRange RangeOf(const EffectParameter& parameter, double value,
                   const std::optional<ValueCertainty>& certainty) {
  ValueRange range{
      parameter.key, LabelOfKey(parameter.key),  UnitOfKey(parameter.key), value, value, value,
      certainty,     IsAtBound(parameter, value)};
  if (!certainty) return range;
  range.low = std::max(parameter.low, value - certainty->HalfInterval());
  range.high = std::min(parameter.high, value + certainty->HalfInterval());
  return range;
}

// Where controllers are along the body, from 0 to 1.
struct HeldEnds {
  bool low, high;
};

HeldEnds FindHeldEnds(const SpringMassSystem& system, const Eigen::VectorXd& along) {
  constexpr double kEnd = 0.25;
  const auto held = along.tail(system.controllers);
  if (held.size() == 0) return {false, false};
  return {held.minCoeff() < kEnd, held.maxCoeff() > 1 - kEnd};
}

bool IsLong(const SpringMassSystem& system) {
  if (!system.rod.empty()) return IsPlain(system.rod);
  const double across = PlaceAcross(system).colwise().norm().maxCoeff();
  const Eigen::Vector3d size =
      system.position.rowwise().maxCoeff() - system.position.rowwise().minCoeff();
  return across < 0.15 * size.norm();
}

}  // namespace

std::vector<ValueRange> RangesOf(const Diagnosis& diagnosis, std::size_t effect) {
  std::size_t at = 0;
  for (std::size_t n = 0; n < effect; ++n) {
    at += static_cast<std::size_t>(diagnosis.effects[n].values.size());
  }
  const EffectValues& found = diagnosis.effects[effect];
  std::vector<ValueRange> ranges;
  for (const EffectParameter& parameter : GetEffect(found.name).parameters()) {
    for (int k = 0; k < parameter.count; ++k, ++at) {
      std::optional<ValueCertainty> certainty;
      const bool moves = parameter.scale > 0;  // else it says what the effect is
      if (moves && at < diagnosis.certainty.size()) certainty = diagnosis.certainty[at];
      const auto i = static_cast<Eigen::Index>(ranges.size());
      ranges.push_back(RangeOf(parameter, found.values[i], certainty));
      if (parameter.count > 1) ranges.back().label += fmt::format(" {}", k + 1);
    }
  }
  return ranges;
}

EffectPicture PictureOf(const Diagnosis& diagnosis, const EffectValues& effect) {
  const Setting setting{diagnosis.twin.levels[0].system, diagnosis.twin.gravity};
  return GetEffect(effect.name).Picture(effect.values, setting);
}

std::string SpacedName(const std::string& name) {
  std::string spaced = name;
  std::replace(spaced.begin(), spaced.end(), '_', ' ');
  return spaced;
}

std::string DescribePlace(const SpringMassSystem& system, const Eigen::Vector3d& place) {
  constexpr double kNear = 0.12;  // of the body's length
  if (!IsLong(system)) return "";
  const Eigen::VectorXd along = BodyCoordinate(system);
  const double at = PatchWeights(system, place).dot(along.head(system.node_count()));
  if (std::abs(at - 0.5) < 0.08) return "in the middle";
  const HeldEnds held = FindHeldEnds(system, along);
  const bool low = at < 0.5, its_end_is_held = low ? held.low : held.high;
  const std::string end = held.low == held.high ? "one end"
                          : its_end_is_held     ? "the held end"
                                                : "the free end";
  return (std::min(at, 1 - at) < kNear ? "near " : "between the middle and ") + end;
}

std::string DescribeEffect(const Diagnosis& diagnosis, std::size_t effect) {
  const EffectPicture picture = PictureOf(diagnosis, diagnosis.effects[effect]);
  std::string words = picture.lacks;
  if (picture.amount >= 0) {
    const ValueRange range = RangesOf(diagnosis, effect)[static_cast<std::size_t>(picture.amount)];
    words += " of about " + FormatQuantity(range.value, range.unit);
    if (range.certainty) {
      words += fmt::format(" ({})", FormatInterval(range.low, range.high, range.unit));
    }
  }
  if (picture.places.empty()) return words;
  const std::string place = DescribePlace(diagnosis.twin.levels[0].system, picture.places[0].place);
  return place.empty() ? words : words + " " + place;
}

}  // namespace physpring
