// SPDX-License-Identifier: Apache-2.0
#include "rollout/effect_keys.h"

#include <gtest/gtest.h>

#include "twin/error.h"

namespace physpring {
namespace {

TEST(ParseEffectTest, ReadsNameAndValue) {
  const auto [name, value] = ParseEffect("tether.anchor_x_m=-0.5");
  EXPECT_EQ(name, "tether.anchor_x_m");
  EXPECT_EQ(value, -0.5);
}

TEST(ParseEffectTest, RefusesOtherNamesAndValues) {
  const auto expect = [](const std::string& text, const std::string& part) {
    try {
      ParseEffect(text);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  expect("wind=3", "there is no effect 'wind', but air_drag.wind_x_m_per_s, ");
  expect("yield.strain=1", "there is no effect 'yield.strain', but yield.yield_strain");
  expect("magnet=1", "there is no effect 'magnet', but air_drag, control_latency, ");
  expect("", "there is no effect '', but air_drag, ");
  for (const char* value : {"", "=", "=x", "=1x", "=nan", "=inf", "=-1", "=1e9"}) {
    expect(std::string("mass_distribution.mass_kg") + value,
           "mass_distribution.mass_kg takes a number from 0 to 100, not '");
  }
}

}  // namespace
}  // namespace physpring
