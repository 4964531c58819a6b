// SPDX-License-Identifier: Apache-2.0
#include "twin/spring_mass_system.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "twin/dashpot_stages.h"
#include "twin/effects/registry.h"
#include "twin/error.h"
#include "twin/level_numbers.h"

namespace physpring {
namespace {

bool IsInRange(double value, double least, double most) {
  return std::isfinite(value) && value >= least && value <= most;
}

[[noreturn]] void FailRange(const std::string& what, double value, double least, double most) {
  const std::string range = most < kAnyNumber        ? fmt::format("{} to {}", least, most)
                            : least >= kMoreThanZero ? "more than 0"
                                                     : "0 or more";
  throw Error(fmt::format("{} is {}, expected {}", what, value, range));
}

// Finite and in [least, most].
void ExpectInRange(const std::string& what, double value, double least, double most) {
  if (!IsInRange(value, least, most)) FailRange(what, value, least, most);
}

void ExpectEach(const std::string& what, const Eigen::VectorXd& values, Eigen::Index size,
                double least) {
  if (values.size() != size) {
    throw Error(fmt::format("{} has {} values, expected {}", what, values.size(), size));
  }
  for (Eigen::Index i = 0; i < size; ++i) {
    if (IsInRange(values[i], least, kAnyNumber)) continue;
    FailRange(fmt::format("{}[{}]", what, i), values[i], least, kAnyNumber);
  }
}

void ValidatePositions(const SpringMassSystem& system, const std::string& where) {
  const Eigen::Index columns = system.position.cols();
  if (system.controllers < 0 || system.controllers >= columns) {
    throw Error(fmt::format("{}: has {} positions, {} of them controllers, expected a node or more",
                            where, columns, system.controllers));
  }
  for (Eigen::Index i = 0; i < columns; ++i) {
    if (system.position.col(i).allFinite()) continue;
    throw Error(fmt::format("{}: position[{}] is not finite", where, i));
  }
}

void ValidateSprings(const SpringMassSystem& system, const std::string& where) {
  const int columns = static_cast<int>(system.position.cols());
  std::vector<std::array<int, 2>> pairs;
  pairs.reserve(system.springs.size());
  for (std::size_t e = 0; e < system.springs.size(); ++e) {
    const auto [a, b] = std::minmax(system.springs[e][0], system.springs[e][1]);
    const auto fail = [&, low = a, high = b](const std::string& expected) {
      throw Error(fmt::format("{}: springs[{}] joins {} and {}, expected {}", where, e, low, high,
                              expected));
    };
    if (a < 0 || b >= columns) fail(fmt::format("numbers from 0 to {}", columns - 1));
    if (a == b) fail("two different nodes");
    if (a >= system.node_count()) fail("a node at one end, both are controllers");
    pairs.push_back({a, b});
  }
  std::sort(pairs.begin(), pairs.end());
  const auto twice = std::adjacent_find(pairs.begin(), pairs.end());
  if (twice == pairs.end()) return;
  throw Error(fmt::format("{}: springs joins {} and {} twice, expected one spring for a pair",
                          where, (*twice)[0], (*twice)[1]));
}

// Each number of the level has the shape and the range that level_numbers.h gives it.
void ValidateNumbers(const SpringMassSystem& system, const std::string& where) {
  for (const LevelList& list : kLevelLists) {
    ExpectEach(fmt::format("{}: {}", where, list.name), list.In(system), list.SizeIn(system),
               list.least);
  }
  for (const LevelScalar& number : kLevelScalars) {
    ExpectInRange(fmt::format("{}: {}", where, number.name), number.In(system), 0, number.most);
  }
}

}  // namespace

std::vector<int> SpringMassSystem::UnjoinedControllers() const {
  std::vector<bool> joined(position.cols(), false);
  for (const auto& [a, b] : springs) joined[a] = joined[b] = true;
  std::vector<int> unjoined;
  for (int c = 0; c < controllers; ++c) {
    if (!joined[node_count() + c]) unjoined.push_back(c);
  }
  return unjoined;
}

void SpringMassSystem::Validate(const std::string& where) const {
  ValidatePositions(*this, where);
  ValidateSprings(*this, where);
  ValidateNumbers(*this, where);
  if (dashpot_stages < 1 || dashpot_stages > kMostDashpotStages) {
    throw Error(fmt::format("{}: dashpot_stages is {}, expected 1 to {}", where, dashpot_stages,
                            kMostDashpotStages));
  }
  for (const EffectValues& effect : effects) ValidateEffect(effect, where);
}

}  // namespace physpring
