// SPDX-License-Identifier: Apache-2.0
#include "report/picture/quantity.h"

#include <gtest/gtest.h>

namespace physpring {
namespace {

TEST(Quantity, TakesTheUnitThatPeopleUse) {
  EXPECT_EQ(FormatQuantity(0.0123, "kg"), "12.3 g");
  EXPECT_EQ(FormatQuantity(2.5, "kg"), "2.50 kg");
  EXPECT_EQ(FormatQuantity(0.04, "s"), "40.0 ms");
  EXPECT_EQ(FormatQuantity(1.2e-4, "N m²"), "0.120 mN m²");
  EXPECT_EQ(FormatQuantity(1.5707963267948966, "rad"), "90.0°");
  EXPECT_EQ(FormatQuantity(-0.5, ""), "-0.500");
}

TEST(Quantity, GivesBothEndsOfAnIntervalInOneUnit) {
  EXPECT_EQ(FormatInterval(0, 0.0014, "kg"), "0.00 to 1.40 g");
  EXPECT_EQ(FormatInterval(-0.002, 1.5, "m"), "-0.00 to 1.50 m");
}

TEST(Quantity, ReadsTheUnitFromAKey) {
  EXPECT_EQ(UnitOfKey("wind_x_m_per_s"), "m/s");
  EXPECT_EQ(LabelOfKey("wind_x_m_per_s"), "wind x");
  EXPECT_EQ(UnitOfKey("relaxing_share"), "");
  EXPECT_EQ(LabelOfKey("relaxing_share"), "relaxing share");
}

}  // namespace
}  // namespace physpring
