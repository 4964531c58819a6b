// SPDX-License-Identifier: Apache-2.0
#include "rollout/installation.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

namespace physpring {
namespace {

TEST(InspectInstallation, FindsTheMujocoItRunsOn) {
  for (const Finding& finding : InspectInstallation()) {
    if (finding.subject != "MuJoCo") continue;
    EXPECT_TRUE(finding.required);
    EXPECT_EQ(finding.problem, "");
    EXPECT_EQ(finding.found.find(mj_versionString()), 0u) << finding.found;
    EXPECT_NE(finding.found.find("libmujoco"), std::string::npos) << finding.found;
    return;
  }
  FAIL() << "no word about MuJoCo";
}

}  // namespace
}  // namespace physpring
