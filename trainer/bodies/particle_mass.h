// SPDX-License-Identifier: Apache-2.0
// How a body's mass is spread over the particles that sample it.
#ifndef PHYSPRING_TRAINER_BODIES_PARTICLE_MASS_H_
#define PHYSPRING_TRAINER_BODIES_PARTICLE_MASS_H_

#include "twin/points.h"
#include "twin/recording.h"

namespace physpring {

// Volume, m^3, that each of `particles` (3 x M, m) stands for: the part of its Voronoi cell that
// lies in the convex hull of its neighbourhood. On a grid that reaches to the surface of a box the
// corners stand for an eighth of a cell. Next to nothing in a plane.
Eigen::VectorXd CellVolumes(const Points& particles);

// Mass, kg, of each point and interior particle; their sum is the recording's mass. By volume for
// solids most of whose particles are unseen (more interior particles than points, no rod), since
// nothing else tells how those move; but never less than a part of the mean: light particles need
// small sub-steps. What a solid has around controllers within it, as at a clamped face, goes to the
// particles nearest to them. Alike for all other bodies.
Eigen::VectorXd ParticleMasses(const Recording& recording);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_BODIES_PARTICLE_MASS_H_
