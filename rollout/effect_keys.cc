// SPDX-License-Identifier: Apache-2.0
#include "rollout/effect_keys.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "twin/error.h"

namespace physpring {
namespace {

constexpr char kPlace[] = "where in the reference configuration; default: the free end";
constexpr char kAnchor[] = "the world point; default: the place";
constexpr char kWind[] = "velocity of the air: option wind";
constexpr char kForce[] = "shared by mass: xfrc_applied";
constexpr char kCentre[] = "middle of its way; default: 0.1 m below the body";

const EffectKey& Find(const std::string& name) {
  const std::vector<EffectKey>& keys = EffectKeys();
  const auto found = std::find_if(keys.begin(), keys.end(),
                                  [&](const EffectKey& key) { return key.name == name; });
  if (found != keys.end()) return *found;
  // those of the effect, or with the word, that is given; else all effects
  std::vector<std::string> near, effects;
  for (const EffectKey& key : keys) {
    const bool has_word = !name.empty() && key.name.find(name) != std::string::npos;
    if (has_word || key.effect() == name.substr(0, name.find('.'))) near.push_back(key.name);
    if (effects.empty() || effects.back() != key.effect()) effects.push_back(key.effect());
  }
  throw Error(fmt::format("there is no effect '{}', but {}", name,
                          fmt::join(near.empty() ? effects : near, ", ")));
}

std::string Bounds(const EffectKey& key) {
  return fmt::format("{} takes a number from {} to {}", key.name, key.low, key.high);
}

}  // namespace

const std::vector<EffectKey>& EffectKeys() {
  static const std::vector<EffectKey> kKeys = {
      {"air_drag.drag_kg_per_m", 0, 100, true,
       "quadratic drag of the whole body: option density, MuJoCo's fluid forces"},
      {"air_drag.wind_x_m_per_s", -30, 30, false, kWind},
      {"air_drag.wind_y_m_per_s", -30, 30, false, kWind},
      {"air_drag.wind_z_m_per_s", -30, 30, false, kWind},
      {"control_latency.latency_s", 0, 2, true, "mocap bodies move so much later than recorded"},
      {"dry_friction.force_n", 0, 1e3, true, "frictionloss of tendons; on flexes along each edge"},
      {"dry_friction.slip_strain", 0, 1, true, "frictionloss k L slip_strain of tendons"},
      {"gravity_direction.tilt_x_rad", -1.5, 1.5, true, "gravity is turned about x"},
      {"gravity_direction.tilt_y_rad", -1.5, 1.5, true, "gravity is turned about y"},
      {"ground_contact.friction_change", -2, 2, true, "friction with the ground, added to its own"},
      {"mass_distribution.mass_kg", 0, 100, true, "mass of the body next to the place"},
      {"mass_distribution.place_x_m", -100, 100, false, kPlace},
      {"mass_distribution.place_y_m", -100, 100, false, kPlace},
      {"mass_distribution.place_z_m", -100, 100, false, kPlace},
      {"moving_attraction.strength_n_m2", -10, 10, true,
       "attraction of the whole body, strength / r^2, to a point that circles: xfrc_applied"},
      {"moving_attraction.radius_m", 0, 10, false, "of its horizontal circle; default: 0.12"},
      {"moving_attraction.rate_rad_per_s", -100, 100, false, "at which it goes round; default: 8"},
      {"moving_attraction.centre_x_m", -100, 100, false, kCentre},
      {"moving_attraction.centre_y_m", -100, 100, false, kCentre},
      {"moving_attraction.centre_z_m", -100, 100, false, kCentre},
      {"rest_length.strain_low_end", -0.8, 4, true,
       "of rest lengths at the low end of the body's longest axis, linear up to the other end"},
      {"rest_length.strain_high_end", -0.8, 4, true, "at the other end"},
      {"stiffening.cubic_n_per_m3", 0, 1e9, true,
       "third stiffness coefficient of tendons; on flexes along each edge"},
      {"stiffening.cubic_stiffness_ratio", 0, 1e4, true,
       "third stiffness coefficient k ratio / L^2 of tendons"},
      {"stiffness_drift.relative_rate_per_s", -2, 2, true,
       "all elastic stiffness times 1 + rate t, at least 0.1"},
      {"tension_only.slack_share", 0, 1, true, "1: springlength of tendons is \"0 L\"; or 0"},
      {"tether.stiffness_n_per_m", 0, 1e4, true,
       "a tendon of length 0 from the place to a world point"},
      {"tether.damping_n_s_per_m", 0, 100, false, "of that tendon, along it; default: 0"},
      {"tether.place_x_m", -100, 100, false, kPlace},
      {"tether.place_y_m", -100, 100, false, kPlace},
      {"tether.place_z_m", -100, 100, false, kPlace},
      {"tether.anchor_x_m", -100, 100, false, kAnchor},
      {"tether.anchor_y_m", -100, 100, false, kAnchor},
      {"tether.anchor_z_m", -100, 100, false, kAnchor},
      {"uniform_force.force_x_n", -1e3, 1e3, true, kForce},
      {"uniform_force.force_y_n", -1e3, 1e3, true, kForce},
      {"uniform_force.force_z_n", -1e3, 1e3, true, kForce},
      {"uniform_force.period_s", 1e-3, 1e3, false,
       "the force times sin(2 pi t / period); default: constant"},
      {"yield.yield_strain", 0, 10, true, "springyield of tendons, yield strain of flexes"},
  };
  return kKeys;
}

std::pair<std::string, double> ParseEffect(const std::string& text) {
  const std::size_t equals = std::min(text.find('='), text.size());
  const EffectKey& key = Find(text.substr(0, equals));
  const std::string number = equals < text.size() ? text.substr(equals + 1) : "";
  double value = 0;
  const char* end = number.data() + number.size();
  const auto [stop, error] = std::from_chars(number.data(), end, value);
  if (number.empty() || error != std::errc() || stop != end || !(value >= key.low) ||
      !(value <= key.high)) {
    throw Error(fmt::format("{}, not '{}'", Bounds(key), number));
  }
  return {key.name, value};
}

void ExpectEffects(const SceneEffects& effects) {
  for (const auto& [name, value] : effects) {
    const EffectKey& key = Find(name);
    if (!(value >= key.low && value <= key.high)) {
      throw Error(fmt::format("{}, not {}", Bounds(key), value));
    }
    std::string amounts;
    bool given = false;
    for (const EffectKey& other : EffectKeys()) {
      if (other.effect() != key.effect() || !other.amount) continue;
      amounts += (amounts.empty() ? "" : " or ") + other.name;
      given |= effects.contains(other.name);
    }
    if (!given) throw Error(fmt::format("{} needs {}, too", name, amounts));
  }
}

}  // namespace physpring
