// SPDX-License-Identifier: Apache-2.0
// How the particles of level 0 and the nodes of a coarser level belong together.
#ifndef PHYSPRING_TWIN_HIERARCHY_H_
#define PHYSPRING_TWIN_HIERARCHY_H_

#include <vector>

#include "twin/points.h"
#include "twin/twin.h"

namespace physpring {

// The level of that number; throws Error if the twin has no such level.
const TwinLevel& LevelOf(const Twin& twin, int level);

// The node of `level` that each free node of level 0 belongs to (the assignments, one after the
// other); the particles themselves at level 0.
std::vector<int> NodesOfParticles(const Twin& twin, int level);

// The nodes of `level` that stand for at least one measured point, ascending.
std::vector<int> SurfaceNodes(const Twin& twin, int level);

// Positions or velocities of the nodes of `level` (3 x nodes): the mass-weighted means of their
// members, whose values are given (3 x free nodes of level 0). Bit for bit the values at level 0.
Points AverageOverMembers(const Twin& twin, int level, const Points& particles);

// Gives the systems of all levels the twin's rod, if it is one (CoarseRod).
void SpreadRod(Twin* twin);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_HIERARCHY_H_
