// SPDX-License-Identifier: Apache-2.0
// Other looks of a scene, for policies that are to see past them: colours, lights, and where
// cameras are. Nothing that moves changes.
#ifndef PHYSPRING_ROLLOUT_LOOKS_H_
#define PHYSPRING_ROLLOUT_LOOKS_H_

#include <mujoco/mujoco.h>

#include <cstdint>

namespace physpring {

// Draws from `seed`, evenly: colours of materials, geoms and skins by up to 30 % a channel, the
// strength of each light by 30 % and its place by 0.3 m along each axis, cameras' places by 10 mm
// along each axis, their directions by 1.5 degrees about each, their field of view by 1.5 degrees.
void VaryLooks(std::uint64_t seed, mjModel* model);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_LOOKS_H_
