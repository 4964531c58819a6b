// SPDX-License-Identifier: Apache-2.0
// How a body's mass is spread over the particles that sample it.
#ifndef PHYSPRING_TRAINER_BODIES_PARTICLE_MASS_H_
#define PHYSPRING_TRAINER_BODIES_PARTICLE_MASS_H_

#include "twin/points.h"
#include "twin/recording.h"

namespace physpring {

// Volume, m^3, that each of `particles` (3 x M, m) stands for: the part of its Voronoi cell that
// lies in the convex hull of its neighbourhood. On a grid that reaches to the surface of a box the
// corners stand for an eighth of a cell. Particles in a plane stand for next to nothing.
Eigen::VectorXd CellVolumes(const Points& particles);

// Mass, kg, of each point and interior particle; their sum is the recording's mass. It is spread by
// volume in solids most of whose particles are unseen (more interior particles than points, no
// rod), since nothing else tells how those move. No particle gets less than a part of the mean,
// because light particles need small sub-steps. What a solid has around controllers within it, as
// at a clamped face, goes to the particles nearest to them. In all other bodies all masses are
// alike.
Eigen::VectorXd ParticleMasses(const Recording& recording);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_BODIES_PARTICLE_MASS_H_
