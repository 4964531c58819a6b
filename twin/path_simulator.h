// SPDX-License-Identifier: Apache-2.0
// A level whose controllers are moved along a path that is not recorded: a plan, or what a robot
// does now. It goes on frame by frame, or along a whole path at once, and its adjoint tells how a
// loss on the motion changes with the path, the start and every parameter. The same motion as
// Predict's (predict.h), bit for bit, where the path is that of a recording.
#ifndef PHYSPRING_TWIN_PATH_SIMULATOR_H_
#define PHYSPRING_TWIN_PATH_SIMULATOR_H_

#include <memory>
#include <vector>

#include "twin/environment.h"
#include "twin/points.h"
#include "twin/spring_mass_system.h"
#include "twin/system_gradient.h"

namespace physpring {

struct PathOptions {
  double fps = 30;                  // frames per second
  int substeps = 0;                 // a frame, >= 1
  bool controller_velocity = true;  // dashpots feel the controllers' velocity
  bool single_precision = false;
};

// Where the nodes start, 3 x nodes: m and m/s.
struct PathStart {
  Points position, velocity;
};

// T frames of 3 x nodes; frame 0 is the start.
struct PathMotion {
  std::vector<Points> position, velocity;
};

// Derivatives of a loss.
struct PathGradient {
  SystemGradient system;
  Points position, velocity;        // at the start, 3 x nodes
  std::vector<Points> controllers;  // T frames of 3 x controllers
};

// Between two frames: the state of the nodes and of effects, and the path so far. To go on from
// elsewhere, or again.
struct PathState {
  double fps = 0;             // of the simulator
  std::vector<double> nodes;  // as the simulator has them
  std::vector<Points> path;   // frames of 3 x controllers, the last one is now
};

class PathSimulator {
 public:
  virtual ~PathSimulator() = default;

  // The motion along `path`, T frames of 3 x controllers, m. Throws Error, naming the frame, where
  // it leaves all bounds (IsFarAway). Does not touch the state.
  virtual PathMotion Roll(const PathStart& start, const std::vector<Points>& path) const = 0;

  // Given d loss / d that motion, 3 x nodes a frame; `velocity_bar` may be empty.
  virtual PathGradient Gradient(const PathStart& start, const std::vector<Points>& path,
                                const std::vector<Points>& position_bar,
                                const std::vector<Points>& velocity_bar) const = 0;

  // A state at the start of a path.
  virtual PathState MakeState(const PathStart& start, const Points& controllers) const = 0;
  // Throws Error unless the state is of a simulator of this level and these frames.
  virtual void ExpectOwn(const PathState& state) const = 0;
  // One frame, in which the controllers go to `controllers`. Throws Error as Roll does.
  virtual void Advance(const Points& controllers, PathState* state) const = 0;
  virtual PathStart Of(const PathState& state) const = 0;
};

// Throws Error for a system that is none (SpringMassSystem::Validate).
std::unique_ptr<PathSimulator> MakePathSimulator(const SpringMassSystem& system,
                                                 const Environment& environment,
                                                 const PathOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_PATH_SIMULATOR_H_
