// SPDX-License-Identifier: Apache-2.0
// The plugin library under a MuJoCo of another version, and under none. Each is tried in a process
// of its own, because a library that is loaded stays.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <string>

namespace physpring {
namespace {

// Loads the plugin in a process with a MuJoCo of that version, which other libraries see if `scope`
// is RTLD_GLOBAL, and prints what the MuJoCo was told. Ends the process.
[[noreturn]] void LoadUnder(int version, int scope) {
  void* mujoco = dlopen(PHYSPRING_FOREIGN_MUJOCO, RTLD_LAZY | scope);
  if (!mujoco) std::exit(1);
  *static_cast<int*>(dlsym(mujoco, "foreign_version")) = version;
  if (!dlopen(PHYSPRING_PLUGIN, RTLD_NOW)) std::exit(1);
  std::fprintf(stderr, "%s; %d registered", static_cast<char*>(dlsym(mujoco, "foreign_warning")),
               *static_cast<int*>(dlsym(mujoco, "foreign_registrations")));
  std::exit(0);
}

std::string Refused(const std::string& version) {
  return "^physpring: this plugin library is for MuJoCo 4.0, not " + version +
         ": its plugins are not registered; build it with that MuJoCo; 0 registered$";
}

TEST(ForeignVersion, RegistersNothing) {
  for (const int scope : {RTLD_GLOBAL, RTLD_LOCAL}) {
    EXPECT_EXIT(LoadUnder(4001000, scope), testing::ExitedWithCode(0), Refused("4.1"));
    EXPECT_EXIT(LoadUnder(3017000, scope), testing::ExitedWithCode(0), Refused("3.17"));
    EXPECT_EXIT(LoadUnder(334, scope), testing::ExitedWithCode(0), Refused("3.3"));
  }
}

TEST(ForeignVersion, RegistersInEveryPatchOfItsOwn) {
  for (const int scope : {RTLD_GLOBAL, RTLD_LOCAL}) {
    EXPECT_EXIT(LoadUnder(4000000, scope), testing::ExitedWithCode(0), "^; 3 registered$");
    EXPECT_EXIT(LoadUnder(4000001, scope), testing::ExitedWithCode(0), "^; 3 registered$");
  }
}

TEST(ForeignVersion, SaysThatThereIsNoMujoco) {
  const auto load = [] { std::exit(dlopen(PHYSPRING_PLUGIN, RTLD_NOW) ? 0 : 1); };
  EXPECT_EXIT(load(), testing::ExitedWithCode(0),
              "^physpring: no MuJoCo is loaded in this program: the plugins are not registered\n$");
}

}  // namespace
}  // namespace physpring
