// SPDX-License-Identifier: Apache-2.0
// A MuJoCo scene with an exported twin in it, in which the twin's controllers go where those of a
// recording went: from the recorded start, linear between frames.
#ifndef PHYSPRING_ROLLOUT_CONTROLLER_REPLAY_H_
#define PHYSPRING_ROLLOUT_CONTROLLER_REPLAY_H_

#include <functional>
#include <string>
#include <vector>

#include "rollout/painter.h"
#include "rollout/scene.h"
#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

struct ReplayOptions {
  std::string video;                 // file; empty: none
  std::vector<std::string> cameras;  // side by side in it; empty: an overview
  PictureQuality quality = PictureQuality::kFast;
  int width = 640, height = 480;
  std::function<void(int frame)> progress;  // before each frame; may throw to stop
};

struct ControllerReplay {
  int level = 0;  // the twin's level in the scene
  int nodes = 0;
  double timestep = 0;            // s, of MuJoCo
  int steps = 0;                  // a frame
  double physics = 0;             // s, all frames
  double rendering = 0;           // s
  std::vector<Points> particles;  // T frames of 3 x level-0 particles, m, lifted
  std::vector<std::string> warnings;
};

// The time step is the scene's, shortened so that a frame is a whole number of them. A level above
// 0 needs the twin (else null), for its start and to lift it to the particles. Throws Error, one
// line that begins with a file, when something is not there, does not fit or is unstable.
ControllerReplay ReplayControllers(const std::string& scene, const Recording& recording,
                                   const Twin* twin, const ReplayOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_CONTROLLER_REPLAY_H_
