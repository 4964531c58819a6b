// SPDX-License-Identifier: Apache-2.0
// Twins that are equal to the last bit.
#ifndef PHYSPRING_TESTS_SUPPORT_SAME_TWIN_H_
#define PHYSPRING_TESTS_SUPPORT_SAME_TWIN_H_

#include <gtest/gtest.h>

#include "twin/twin.h"

namespace physpring {

inline void ExpectSameSystem(const SpringMassSystem& a, const SpringMassSystem& b) {
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.springs, b.springs);
  EXPECT_EQ(a.stiffness, b.stiffness);
  EXPECT_EQ(a.rest_length, b.rest_length);
  EXPECT_EQ(a.dashpot, b.dashpot);
  EXPECT_EQ(a.drag, b.drag);
  EXPECT_EQ(a.contact.surface.restitution, b.contact.surface.restitution);
  EXPECT_EQ(a.contact.surface.friction, b.contact.surface.friction);
  ASSERT_EQ(a.effects.size(), b.effects.size());
  for (std::size_t i = 0; i < a.effects.size(); ++i) {
    EXPECT_EQ(a.effects[i].values, b.effects[i].values) << a.effects[i].name;
  }
}

inline void ExpectSameTwin(const Twin& a, const Twin& b) {
  ASSERT_EQ(a.levels.size(), b.levels.size());
  for (std::size_t l = 0; l < a.levels.size(); ++l) {
    SCOPED_TRACE(l);
    EXPECT_EQ(a.levels[l].assignment, b.levels[l].assignment);
    EXPECT_EQ(a.levels[l].substeps_per_second, b.levels[l].substeps_per_second);
    ExpectSameSystem(a.levels[l].system, b.levels[l].system);
  }
  EXPECT_EQ(a.posterior.stiffness, b.posterior.stiffness);
  EXPECT_EQ(a.posterior.loss_time, b.posterior.loss_time);
  EXPECT_EQ(a.posterior.drag, b.posterior.drag);
  EXPECT_EQ(a.posterior.contact, b.posterior.contact);
  EXPECT_EQ(a.posterior.effects, b.posterior.effects);
}

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_SAME_TWIN_H_
