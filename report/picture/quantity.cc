// SPDX-License-Identifier: Apache-2.0
#include "report/picture/quantity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace physpring {
namespace {

struct KeyUnit {
  const char *ending, *unit;
};

// longer endings first
constexpr KeyUnit kKeyUnits[] = {{"_n_s_per_m", "N s/m"},
                                 {"_kg_per_m", "kg/m"},
                                 {"_m_per_s", "m/s"},
                                 {"_n_per_m", "N/m"},
                                 {"_n_m2_s", "N m² s"},
                                 {"_n_m2", "N m²"},
                                 {"_n_m", "N m"},
                                 {"_per_m", "1/m"},
                                 {"_per_s", "1/s"},
                                 {"_rad", "rad"},
                                 {"_kg", "kg"},
                                 {"_m", "m"},
                                 {"_s", "s"},
                                 {"_n", "N"}};

const KeyUnit* FindKeyUnit(const std::string& key) {
  for (const KeyUnit& known : kKeyUnits) {
    if (key.ends_with(known.ending)) return &known;
  }
  return nullptr;
}

const char* SpaceBefore(const Scale& scale) {
  return scale.unit.empty() || scale.unit == "°" ? "" : " ";
}

}  // namespace

Scale ScaleFor(const std::string& unit, double largest) {
  const double size = std::abs(largest);
  if (unit == "rad") return {180 / std::numbers::pi, "°"};
  if (unit == "m/s^2") return {1, "m/s²"};
  if (size == 0 || size >= 1) return {1, unit};
  if (unit == "kg") return size < 1e-3 ? Scale{1e6, "mg"} : Scale{1e3, "g"};
  if (unit == "m") return {1e3, "mm"};
  if (unit == "kg/m") return {1e3, "g/m"};
  if (size >= 0.1) return {1, unit};
  if (unit == "s") return {1e3, "ms"};
  if (!unit.starts_with('N')) return {1, unit};
  return size < 1e-4 ? Scale{1e6, "µ" + unit} : Scale{1e3, "m" + unit};
}

std::string Digits(double value) {
  if (value == 0) return "0";
  const double magnitude = std::floor(std::log10(std::abs(value)) + 1e-9);
  if (magnitude < -3 || magnitude >= 6) return fmt::format("{:.3g}", value);
  return fmt::format("{:.{}f}", value, static_cast<int>(std::max(0.0, 2 - magnitude)));
}

std::string InMm(double metres) {
  const double millimetres = 1e3 * metres;
  const int digits = millimetres < 9.995 ? 2 : millimetres < 99.95 ? 1 : 0;
  return fmt::format("{:.{}f}", millimetres, digits);
}

std::string FormatQuantity(double value, const std::string& unit) {
  const Scale scale = ScaleFor(unit, value);
  return Digits(scale.factor * value) + SpaceBefore(scale) + scale.unit;
}

// Both ends with as many digits as tell the larger one to three, and their distance to one.
std::string FormatInterval(double low, double high, const std::string& unit) {
  const double largest = std::max(std::abs(low), std::abs(high));
  const Scale scale = ScaleFor(unit, largest);
  const auto magnitude = [&](double value) {
    return value > 0 ? std::floor(std::log10(scale.factor * value) + 1e-9) : 2;
  };
  const int digits = static_cast<int>(
      std::clamp(std::max(2 - magnitude(largest), -magnitude(high - low)), 0.0, 7.0));
  return fmt::format("{:.{}f} to {:.{}f}{}{}", scale.factor * low, digits, scale.factor * high,
                     digits, SpaceBefore(scale), scale.unit);
}

std::string UnitOfKey(const std::string& key) {
  const KeyUnit* known = FindKeyUnit(key);
  return known ? known->unit : "";
}

std::string Capitalised(std::string sentence) {
  if (!sentence.empty() && sentence[0] >= 'a' && sentence[0] <= 'z') sentence[0] += 'A' - 'a';
  return sentence;
}

std::string LabelOfKey(const std::string& key) {
  const KeyUnit* known = FindKeyUnit(key);
  std::string label = known ? key.substr(0, key.size() - std::string(known->ending).size()) : key;
  std::replace(label.begin(), label.end(), '_', ' ');
  return label;
}

}  // namespace physpring
