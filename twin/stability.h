// SPDX-License-Identifier: Apache-2.0
// The largest stable sub-step of the simulator's semi-implicit Euler step.
//
// A mode of frequency omega and damping rate gamma (v <- v - h (omega^2 x + gamma v), x <- x + h v)
// is stable while h^2 omega^2 + 2 h gamma < 4; with dashpots in stages see dashpot_stages.h. The
// largest eigenvalues of M^-1 K and M^-1 C bound omega^2 and gamma; K and C are taken as scalar
// Laplacians, which bound the true (directional) matrices in every configuration: k n n^T + k (1 -
// L / l) (I - n n^T) <= k I. Effects count as springs that are as stiff (Effect::Stiffen).
#ifndef PHYSPRING_TWIN_STABILITY_H_
#define PHYSPRING_TWIN_STABILITY_H_

#include "twin/spring_mass_system.h"

namespace physpring {

struct StabilityBound {
  double omega_max;        // rad/s, from above, less than 0.1 % too high
  double gamma_max;        // 1/s, from above, less than 0.2 % too high
  double other_gamma_max;  // the part of it that is not of the springs' dashpots, from above
  double timestep;  // s: largest stable sub-step of the system's stages (no safety taken off)

  double TimestepOf(int stages) const;  // s: that with so many stages
  // s: the simulated time, at most, that costs as much as a sub-step of one stage, where there may
  // be so many stages.
  double CheapestTimestep(int most_stages) const;
};

// By Lanczos' method; springs of stiffness and dashpot 0 bound nothing (timestep is then infinite).
StabilityBound ComputeStabilityBound(const SpringMassSystem& system);

// The same without a search, in a tenth of the time: omega^2 and gamma up to twice too high. What
// is stable by it is stable.
StabilityBound RoughStabilityBound(const SpringMassSystem& system);

// Lowers all dashpots by one factor, as far as it takes for a CheapestTimestep of `timestep` with
// at most the system's stages. Returns whether that is reached.
bool LimitDashpots(double timestep, SpringMassSystem* system);

// Lowers stiffness and dashpots of the springs at each node whose own
//   h^2 sum k / m + 2 h sum c / m
// (sums over its springs) is above 2, the more of a spring's two ends counting: by Gershgorin's
// theorem `timestep` h [s] then is stable. With dashpots in stages, the sums of k and of c have a
// limit each. Effects are not looked at.
void SoftenStiffNodes(double timestep, SpringMassSystem* system);

// Share of the bound's time step that automatic sub-steps stay below.
constexpr double kStepSafety = 0.7;

// Least number of sub-steps of a frame of `frame_time` seconds that keeps each below
// safety * timestep.
int StableSubsteps(double timestep, double frame_time, double safety);
inline int StableSubsteps(const StabilityBound& bound, double frame_time, double safety) {
  return StableSubsteps(bound.timestep, frame_time, safety);
}

// What a sub-step of so many stages costs, in those of one.
double CostOf(int dashpot_stages);

// How a frame is cut.
struct FrameCut {
  int substeps, dashpot_stages;
};
// The cheapest stable one, of at most so many stages.
FrameCut CheapestCut(const StabilityBound& bound, double frame_time, double safety,
                     int most_stages);
// The fewest stages that are stable with sub-steps of `timestep` s, but at most so many.
int FewestStages(const StabilityBound& bound, double timestep, int most_stages);
// With at most the system's stages: the cheapest, or so many sub-steps with the fewest stages.
FrameCut CutFrames(double frame_time, int substeps, const SpringMassSystem& system);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_STABILITY_H_
