// SPDX-License-Identifier: Apache-2.0
// The system that the benchmarks simulate: a rope of nodes at random, as in make_rope_twin.py.
#ifndef PHYSPRING_BENCH_ROPE_H_
#define PHYSPRING_BENCH_ROPE_H_

#include "twin/spring_mass_system.h"

namespace physpring {

// `nodes` nodes at random in a cylinder of 1 m x 4 cm that rests on the ground z = 0, in random
// order, with the `springs` shortest springs between near ones; PhysTwin's usual values for a
// sub-step of 1 / 20010 s. Equal arguments give equal systems.
SpringMassSystem MakeRope(int nodes, int springs);

}  // namespace physpring

#endif  // PHYSPRING_BENCH_ROPE_H_
