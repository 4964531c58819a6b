// SPDX-License-Identifier: Apache-2.0
// The MuJoCo of this process. The program is linked with one. That of the Python package is not: it
// opens the one that the variable PHYSPRING_MUJOCO names, so that all else works without any.
#ifndef PHYSPRING_ROLLOUT_MUJOCO_LIBRARY_H_
#define PHYSPRING_ROLLOUT_MUJOCO_LIBRARY_H_

#include <filesystem>

namespace physpring {

// Throws Error where none is there, or one whose version differs in more than the last number:
// patches keep mjModel and mjData as they are. To be called before any of MuJoCo's functions.
void ExpectMujoco();

// The path of the library; empty: none is there.
std::filesystem::path MujocoLibrary();

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_MUJOCO_LIBRARY_H_
