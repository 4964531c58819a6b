// SPDX-License-Identifier: Apache-2.0
// What this program runs on: its own version and compiler, the MuJoCo library that was really
// loaded with its plugins, the software OpenGL for pictures, the processor.
#ifndef PHYSPRING_ROLLOUT_INSTALLATION_H_
#define PHYSPRING_ROLLOUT_INSTALLATION_H_

#include <string>
#include <vector>

namespace physpring {

struct Finding {
  std::string subject;       // "MuJoCo"
  std::string found;         // "4.0.0, /opt/mujoco/lib/libmujoco.so.4.0.0"
  std::string problem = "";  // what is wrong and what would be right; empty: nothing
  bool required = false;     // whether the problem keeps the program from working at all
};

// Loads MuJoCo's first-party plugins from $MUJOCO_PLUGIN_DIR, or from where a wheel or a release
// has them, and opens OSMesa, to see whether they work. A part that is missing is a finding, not an
// Error.
std::vector<Finding> InspectInstallation();

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_INSTALLATION_H_
