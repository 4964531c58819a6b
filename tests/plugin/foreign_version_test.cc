// SPDX-License-Identifier: Apache-2.0
// The plugin library under a MuJoCo of another version, and under none.
#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace physpring {
namespace {

// In this order: once a MuJoCo is loaded, it stays.
TEST(ForeignVersion, NeedsMujocoToLoad) {
  EXPECT_EQ(dlopen(PHYSPRING_PLUGIN, RTLD_LAZY), nullptr);
  EXPECT_THAT(dlerror(), testing::HasSubstr("libmujoco.so.4.0.0"));
}

TEST(ForeignVersion, RegistersNothing) {
  void* mujoco = dlopen(PHYSPRING_FOREIGN_MUJOCO, RTLD_LAZY | RTLD_GLOBAL);
  ASSERT_NE(mujoco, nullptr) << dlerror();
  ASSERT_NE(dlopen(PHYSPRING_PLUGIN, RTLD_LAZY), nullptr) << dlerror();
  EXPECT_EQ(*static_cast<int*>(dlsym(mujoco, "foreign_registrations")), 0);
  EXPECT_STREQ(static_cast<char*>(dlsym(mujoco, "foreign_warning")),
               "physpring: this plugin library is for MuJoCo 4000000, not 4001000: "
               "its plugins are not registered");
}

}  // namespace
}  // namespace physpring
