// SPDX-License-Identifier: Apache-2.0
// The 12 variables of PhysTwin's first stage, in its units (nodes of 1 kg), their ranges, and the
// spring-mass system they stand for. With the mass m of a particle and the rest length L,
//   k = Y / L m,   c = dashpot m
// give true masses the motion that PhysTwin's nodes have.
#ifndef PHYSPRING_TRAINER_BODIES_PHYSTWIN_VARIABLES_H_
#define PHYSPRING_TRAINER_BODIES_PHYSTWIN_VARIABLES_H_

#include "twin/recording.h"
#include "twin/spring_mass_system.h"

namespace physpring {

inline constexpr int kPhysTwinVariables = 12;
inline constexpr double kPhysTwinLargestY = 1e5;  // N, also in its second stage
inline constexpr double kPhysTwinSubstep = 5e-5;  // s
inline constexpr double kPhysTwinSpacing = 5e-3;  // m, of its particles

struct PhysTwinVariables {
  double spring_y = 0;            // Y, N: force of a spring stretched to twice its length
  double object_radius = 0;       // m, of the neighbour search
  int object_neighbours = 0;      // at most, the particle itself counted
  double controller_radius = 0;   // m
  int controller_neighbours = 0;  // at most
  double restitution = 0;         // of the ground
  double friction = 0;            // of the ground
  double object_restitution = 0;  // between particles
  double object_friction = 0;     // between particles
  double collision_distance = 0;  // m, between particles
  double drag = 0;                // 1/s
  double dashpot = 0;             // 1/s: N s/m for a node of 1 kg
};

// The variables at a point of the unit cube (12). Lengths are `length_scale` times PhysTwin's.
// Counts are cut to whole numbers, drag and dashpot are not (PhysTwin's second stage cuts them, by
// a cast in its configuration).
PhysTwinVariables FromUnitCube(const Eigen::VectorXd& point, double length_scale);

// Where PhysTwin's search starts: its default parameters, as a point of the unit cube.
Eigen::VectorXd PhysTwinStart();

// PhysTwin's radii are made for particles 5 mm apart. For a recording whose particles are further
// apart (median distance to the nearest), the factor by which; else 1.
double PhysTwinLengthScale(const Recording& recording);

// Passes of PhysTwin's second stage: 100 for a sheet (no interior particles, and stress-free one
// flat layer, some particles wide), else 200.
int PhysTwinPasses(const Recording& recording);

// The system of `variables`, its springs searched in the recording's stress-free positions. Groups
// of particles that the search leaves apart are joined (topology.h), which PhysTwin does not do.
// Particles collide with each other only with `self_collision`. Throws Error as MakeStartSystem.
SpringMassSystem MakePhysTwinSystem(const Recording& recording, const PhysTwinVariables& variables,
                                    bool self_collision);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_BODIES_PHYSTWIN_VARIABLES_H_
