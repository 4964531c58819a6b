// SPDX-License-Identifier: Apache-2.0
#include "report/material_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace physpring {
namespace {

// Springs that are so much softer than the stiffest ones carry little: that is told.
constexpr double kWeak = 0.2;

// "6.45 N (6.4 to 6.5)", in units of `unit`.
std::string Words(const Estimate& estimate, const char* unit, double scale = 1) {
  const double value = scale * estimate.value, low = scale * estimate.low,
               high = scale * estimate.high;
  if (!estimate.IsTold() && estimate.low <= 0) return fmt::format("below {:.3g}{}", high, unit);
  return fmt::format("{:.4g}{} ({:.4g} to {:.4g})", value, unit, low, high);
}

std::string Words(const Material::Place& place) {
  const Eigen::Vector3d& at = place.position;
  return fmt::format("{} at ({:.3f}, {:.3f}, {:.3f}) m", Words(place.factor, " times"), at[0],
                     at[1], at[2]);
}

std::string LengthsOf(const Material::LengthClass& one) {
  const std::string shortest = fmt::format("{:.1f}", 1e3 * one.shortest),
                    longest = fmt::format("{:.1f}", 1e3 * one.longest);
  return shortest == longest ? shortest + " mm" : shortest + " to " + longest + " mm";
}

}  // namespace

std::vector<std::string> UntoldOf(const Material& material) {
  double stiffest = 0;
  for (const auto& one : material.classes) {
    stiffest = std::max(stiffest, one.axial_stiffness.value);
  }
  std::vector<std::string> untold;
  for (const auto& one : material.classes) {
    const bool weak = one.axial_stiffness.high < kWeak * stiffest;
    if (!weak && !one.axial_stiffness.IsTold()) untold.push_back("springs of " + LengthsOf(one));
  }
  if (!material.loss_time.IsTold()) untold.emplace_back("the loss time");
  if (!material.drag.IsTold()) untold.emplace_back("drag");
  return untold;
}

std::string DescribeMaterial(const Material& material) {
  std::string text =
      "material, with 90 % intervals; a spring's stiffness is the first number over its length\n";
  for (const auto& one : material.classes) {
    text += fmt::format("  {:<24} {} springs of {}\n", Words(one.axial_stiffness, " N"),
                        one.springs, LengthsOf(one));
  }
  text += fmt::format("  loss time {}, drag {}\n", Words(material.loss_time, " ms", 1e3),
                      Words(material.drag, " 1/s"));
  text += fmt::format("  softest place {}\n  stiffest place {}\n", Words(material.softest),
                      Words(material.stiffest));
  const std::vector<std::string> untold = UntoldOf(material);
  if (untold.empty()) return text;
  return text +
         fmt::format("  uncertain by more than a factor of 2: {}\n", fmt::join(untold, ", "));
}

}  // namespace physpring
