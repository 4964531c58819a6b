// SPDX-License-Identifier: Apache-2.0
#include "rollout/plugin_library.h"

#include <mujoco/mujoco.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "rollout/mujoco_log.h"
#include "twin/error.h"

namespace physpring {
namespace {

namespace fs = std::filesystem;

bool IsRegistered() {
  int slot = -1;
  return mjp_getPlugin("physpring.springs", &slot) != nullptr;
}

fs::path FindLibrary() {
  if (const char* path = std::getenv("PHYSPRING_PLUGIN")) return path;
  const fs::path folder = fs::canonical("/proc/self/exe").parent_path();
  for (const char* place : {"plugin", "mujoco_plugin", "../plugin", "../lib"}) {
    const fs::path file = folder / place / "libphyspring_plugin.so";
    if (fs::exists(file)) return file;
  }
  throw Error(
      "libphyspring_plugin.so is not beside this program: scripts/setup builds it, or the variable "
      "PHYSPRING_PLUGIN can name it");
}

}  // namespace

void LoadPluginLibrary(std::string file) {
  if (IsRegistered()) return;
  if (file.empty()) file = FindLibrary().string();
  if (!fs::exists(file)) throw Error(file + ": does not exist, expected libphyspring_plugin.so");
  CatchMujoco([&] { mj_loadPluginLibrary(file.c_str()); });
  if (!IsRegistered()) throw Error(file + ": does not register physpring.springs");
}

}  // namespace physpring
