// SPDX-License-Identifier: Apache-2.0
#include "twin/checks/plausibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "twin/checks/frame_times.h"
#include "twin/checks/grasp.h"
#include "twin/checks/missing_ground.h"
#include "twin/checks/motion_scale.h"
#include "twin/checks/rod_shape.h"
#include "twin/checks/smooth_motion.h"

namespace physpring {
namespace {

// Objects that people hold are moved more gently: m/s^2, but for a hundredth of the measurements.
constexpr double kFastest = 300;
constexpr double kMoves = 2;           // a motion is larger than so many times the noise
constexpr double kLeastMotion = 1e-5;  // m
constexpr double kBelowGround = 2;     // spacings
constexpr double kSteepGround = 0.85;  // cosine of the angle between its normal and gravity
constexpr double kLeastExplained = 0.55;
constexpr double kBeyondNoise = 6;  // errors nearer to the noise are good, whatever moves

using Lines = std::vector<std::string>;

void CheckUnits(const Recording& recording, const MotionScale& scale, Lines* lines) {
  const double fast = Quantile(0.99, AccelerationSizes(recording));
  if (scale.size > kLargestObject) {
    lines->push_back(fmt::format(
        "the object measures {:.3g} m and its points accelerate by up to {:.3g} m/s^2: are "
        "positions in metres?",
        scale.size, fast));
  } else if (recording.point_count() > 1 && scale.size < kSmallestObject) {
    lines->push_back(
        fmt::format("the object measures {:.3g} m: are positions in metres?", scale.size));
  } else if (fast > kFastest) {
    lines->push_back(fmt::format(
        "points accelerate by up to {:.3g} m/s^2: are positions in metres, and is fps {:g} right?",
        fast, recording.fps));
  }
}

bool KnownAtStartAlone(const Recording& recording) {
  return std::none_of(recording.points.begin() + 1, recording.points.end(),
                      [](const Points& frame) { return frame.array().isFinite().any(); });
}

void CheckMotion(const Recording& recording, const MotionScale& scale, Lines* lines) {
  if (scale.motion > kMoves * std::sqrt(3.0) * scale.noise && scale.motion > kLeastMotion) return;
  if (!recording.surface.empty() && KnownAtStartAlone(recording)) return;  // clouds may move
  const double hands = MotionOfControllers(recording);
  const bool held_still = hands < 2 * scale.motion;
  lines->push_back(fmt::format(
      "nothing moves: points stay within {:.3g} m of their places, which is noise{}", scale.motion,
      held_still ? "" : fmt::format(", while the controllers move by {:.3g} m", hands)));
}

void CheckGround(const Recording& recording, const MotionScale& scale, Lines* lines) {
  if (!recording.ground) return;
  const Eigen::Vector3d normal = recording.ground->head<3>();
  const double along = -normal.dot(recording.gravity);
  if (recording.gravity.norm() > 0 && along < kSteepGround * recording.gravity.norm()) {
    lines->push_back(fmt::format(
        "gravity ({:.3g}, {:.3g}, {:.3g}) does not pull towards the ground, whose normal is "
        "({:.3g}, {:.3g}, {:.3g}): does z point up?",
        recording.gravity[0], recording.gravity[1], recording.gravity[2], normal[0], normal[1],
        normal[2]));
  }
  const Points points = recording.start.leftCols(recording.point_count());
  const double lowest = (normal.transpose() * points).minCoeff() - (*recording.ground)[3];
  if (lowest < -kBelowGround * std::max(scale.spacing, 3 * scale.noise)) {
    lines->push_back(fmt::format("the object starts {:.3g} m below the ground", -lowest));
  }
}

}  // namespace

std::vector<std::string> FindOddities(const Recording& recording) {
  const MotionScale scale = ScaleOf(recording);
  Lines lines;
  CheckUnits(recording, scale, &lines);
  CheckMotion(recording, scale, &lines);
  CheckGround(recording, scale, &lines);
  if (!lines.empty()) return lines;                          // what follows takes these to be right
  const std::string lies = MissingGround(recording, scale);  // then nothing hangs
  for (const std::string& line :
       {lies.empty() ? OddGravity(recording, scale) : lies, FarGrasp(recording, scale),
        ReleasedGrasp(recording, scale), OddRod(recording, scale), OddFrameTimes(recording)}) {
    if (!line.empty()) lines.push_back(line);
  }
  return lines;
}

std::string TooLittleExplained(double track, double motionless, double noise) {
  if (track < (1 - kLeastExplained) * motionless || track < kBeyondNoise * noise) return "";
  return fmt::format(
      "the twin explains {:.0f} % of the motion ({:.3g} of {:.3g} mm are left): are units, "
      "gravity, "
      "ground, fps, the start and the controllers right?",
      std::max(0.0, 100 * (1 - track / motionless)), 1e3 * track, 1e3 * motionless);
}

}  // namespace physpring
