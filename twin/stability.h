// SPDX-License-Identifier: Apache-2.0
// The largest stable sub-step of the simulator's semi-implicit Euler step.
//
// A mode of frequency omega and damping rate gamma (v <- v - h (omega^2 x + gamma v), x <- x + h v)
// is stable while h^2 omega^2 + 2 h gamma < 4. The largest eigenvalues of M^-1 K and M^-1 C bound
// omega^2 and gamma; K and C are taken as scalar Laplacians, which bound the true (directional)
// matrices in every configuration: k n n^T + k (1 - L / l) (I - n n^T) <= k I. Effects count as
// springs that are as stiff (Effect::Stiffen).
#ifndef PHYSPRING_TWIN_STABILITY_H_
#define PHYSPRING_TWIN_STABILITY_H_

#include "twin/spring_mass_system.h"

namespace physpring {

struct StabilityBound {
  double omega_max;  // rad/s, from above, less than 0.1 % too high
  double gamma_max;  // 1/s, from above, less than 0.2 % too high
  double timestep;   // s: largest stable sub-step (no safety taken off)
};

// By Lanczos' method; springs of stiffness and dashpot 0 bound nothing (timestep is then infinite).
StabilityBound ComputeStabilityBound(const SpringMassSystem& system);

// The same without a search, in a tenth of the time: omega^2 and gamma up to twice too high. What
// is stable by it is stable.
StabilityBound RoughStabilityBound(const SpringMassSystem& system);

// Lowers all dashpots by one factor, as far as it takes to make `timestep` stable. Returns whether
// it then is.
bool LimitDashpots(double timestep, SpringMassSystem* system);

// Lowers stiffness and dashpots of the springs at each node whose own
//   h^2 sum k / m + 2 h sum c / m
// (sums over its springs) is above 2, the more of a spring's two ends counting: by Gershgorin's
// theorem `timestep` h [s] then is stable. Effects are not looked at.
void SoftenStiffNodes(double timestep, SpringMassSystem* system);

// Share of the bound's time step that automatic sub-steps stay below.
constexpr double kStepSafety = 0.7;

// Least number of sub-steps of a frame of `frame_time` seconds that keeps each below
// safety * bound.timestep.
int StableSubsteps(const StabilityBound& bound, double frame_time, double safety);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_STABILITY_H_
