// SPDX-License-Identifier: Apache-2.0
// The engine plugin that exported levels need, loaded into this process.
#ifndef PHYSPRING_ROLLOUT_PLUGIN_LIBRARY_H_
#define PHYSPRING_ROLLOUT_PLUGIN_LIBRARY_H_

#include <string>

namespace physpring {

// Loads libphyspring_plugin.so unless its plugins are there already: `file` if given, else what the
// environment variable PHYSPRING_PLUGIN names, else the one in plugin/ (the build folder),
// mujoco_plugin/ or ../lib/ beside this program. Throws Error when it is nowhere or registers
// nothing.
void LoadPluginLibrary(std::string file = "");

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_PLUGIN_LIBRARY_H_
