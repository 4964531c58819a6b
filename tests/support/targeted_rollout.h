// SPDX-License-Identifier: Apache-2.0
// A short rollout with a loss on it, as a trainer makes one: several frames one after the other,
// and the gradient of the loss through all of them.
#ifndef PHYSPRING_TESTS_SUPPORT_TARGETED_ROLLOUT_H_
#define PHYSPRING_TESTS_SUPPORT_TARGETED_ROLLOUT_H_

#include <vector>

#include "tests/support/gradient_check.h"
#include "twin/simulator.h"

namespace physpring {

// loss = sum over frames and nodes of weight / 2 |x - target|^2
struct TargetedRollout {
  SpringMassSystem system;
  Environment environment;
  SimulationOptions options;
  std::vector<FrameInput> frames;
  Points position, velocity;   // of the free nodes at the start, 3 x nodes
  std::vector<Points> target;  // after each frame, 3 x nodes, m
  std::vector<Points> weight;  // of each coordinate after each frame, 3 x nodes
};

struct RolloutGradient {
  SystemGradient system;
  Points position, velocity;  // with respect to the start, 3 x nodes
  // with respect to the controllers of each frame, 3 x controllers
  std::vector<Points> controllers_start, controllers_end;
};

// `count` frames of RandomSystem(25, 2, seed) (about 100 springs) in free space: the controllers
// move along random lines, the nodes start off their rest positions with random velocities.
// Sub-step of 1 ms.
TargetedRollout RandomRollout(int count, std::uint64_t seed);

// Positions after each frame, 3 x nodes.
template <class Real>
std::vector<Points> Simulate(const TargetedRollout& rollout);

template <class Real>
long double Loss(const TargetedRollout& rollout);

template <class Real>
RolloutGradient Gradient(const TargetedRollout& rollout);

// Compares the gradient of the double simulator with differences for every learnable quantity, one
// report a quantity. `step` is relative to the quantity's usual size.
std::vector<GradientReport> CheckRollout(TargetedRollout rollout, double step);

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_TARGETED_ROLLOUT_H_
