// SPDX-License-Identifier: Apache-2.0
// Recordings of simulated objects: a MuJoCo scene with one soft body, moved by mocap bodies, as a
// camera would see it. A flex's mechanics (finite elements, rods, shells, MuJoCo's contacts) have
// nothing in common with a twin's, so a twin that explains it has learned something; a body of
// tendons is what a twin is, too.
//
// Motion: mocap_path.h. What is measured and what is held: soft_points.h. Measurement:
// observation.h. What the recording does not tell: undeclared_effects.h. Pictures:
// record_pictures.h.
#ifndef PHYSPRING_ROLLOUT_RECORD_H_
#define PHYSPRING_ROLLOUT_RECORD_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "rollout/effect_keys.h"
#include "rollout/record_pictures.h"
#include "twin/recording.h"

namespace physpring {

struct RecordOptions {
  double noise = 0;        // m, standard deviation of each measured coordinate; frame 0 is exact
  double occlusion = 0;    // in [0, 1): fraction of points hidden in each frame; in frame 0 none
  double vary = 0;         // m: keyframes are shifted by up to this, see MocapPath::Vary
  std::uint64_t seed = 0;  // for noise, occlusion and variation, each independent of the others
  std::optional<double> duration = {};  // s; default: until the last keyframe
  double fps = 30;                      // frames per second
  SceneEffects effects = {};            // that the recording does not declare
  PictureOptions pictures = {};         // that cameras take beside
  std::function<void(double part)> progress = {};
};

// Simulates the scene from its first keyframe and records it from time 0 on (a first keyframe at a
// negative time lets the object settle before). Sub-steps are the scene's time step, shortened so
// that a frame is a whole number of them. `rest` is given where frame 0 is not the scene's
// reference configuration, in which the body is taken to be stress-free. Ground is the one plane
// that the body can collide with; other such geoms are warned of, because a recording does not hold
// them. Mass and gravity are the scene's own, without the effects.
//
// Throws Error, one line that begins with `scene_path`: unreadable scene, compiler error, options
// out of range, a scene that is not one soft body held by mocap bodies or cannot have an effect, an
// unstable simulation, pictures that cannot be drawn or written.
Recording RecordScene(const std::string& scene_path, const RecordOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_RECORD_H_
