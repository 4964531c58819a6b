// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TRAINER_BODIES_BENDING_CHAIN_H_
#define PHYSPRING_TRAINER_BODIES_BENDING_CHAIN_H_

#include "trainer/bodies/body.h"

namespace physpring {

// A chain of nodes that bends as a rod does: with stiffness, friction between its strands, twist
// (no branches) and a shape of its own, all fitted. Where effects of bending are among those of
// `body` already, it is a net of springs along the rod.
Body BendingChain(const Recording& recording, Body body);

// Whether a system's particles are joined to the next along a rod only (at joints: ChainSprings),
// which bends by an effect.
bool IsBendingChain(const SpringMassSystem& system);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_BODIES_BENDING_CHAIN_H_
