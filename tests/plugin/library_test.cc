// SPDX-License-Identifier: Apache-2.0
// How C++ programs load the plugin library; loading_test.py has Python's ways.
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <filesystem>

#include "tests/support/temporary_folder.h"

namespace physpring {
namespace {

void ExpectRegistered() {
  for (const char* name : {"physpring.springs", "physpring.contact", "physpring.force"}) {
    int slot = -1;
    EXPECT_NE(mjp_getPlugin(name, &slot), nullptr) << name;
  }
}

TEST(Library, LoadsByItsPath) {
  mj_loadPluginLibrary(PHYSPRING_PLUGIN);
  ExpectRegistered();
}

TEST(Library, LoadsWithAllOfAFolder) {
  const TemporaryFolder folder;
  std::filesystem::create_symlink(PHYSPRING_PLUGIN, folder.File("libphyspring_plugin.so"));
  mj_loadAllPluginLibraries(folder.File("").c_str(), nullptr);
  ExpectRegistered();
}

}  // namespace
}  // namespace physpring
