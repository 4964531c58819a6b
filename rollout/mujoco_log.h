// SPDX-License-Identifier: Apache-2.0
// MuJoCo's messages as a C++ library wants them: errors are thrown, warnings are returned. (Left
// alone, MuJoCo prints warnings, writes MUJOCO_LOG.TXT and ends the process at an error.)
#ifndef PHYSPRING_ROLLOUT_MUJOCO_LOG_H_
#define PHYSPRING_ROLLOUT_MUJOCO_LOG_H_

#include <functional>
#include <string>
#include <vector>

namespace physpring {

// Runs `call` and returns the warnings that MuJoCo issued in this thread meanwhile, one line each.
// Throws Error with MuJoCo's message where MuJoCo stops with an error. MuJoCo then leaves `call` by
// longjmp, so `call` must not hold objects with destructors.
std::vector<std::string> CatchMujoco(const std::function<void()>& call);

// The same; the warnings go to `warnings`, each one after "where: ".
void CatchMujoco(const std::string& where, const std::function<void()>& call,
                 std::vector<std::string>* warnings);

// `message` on one line: line breaks become "; ".
std::string OneLine(const std::string& message);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_MUJOCO_LOG_H_
