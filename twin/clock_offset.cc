// SPDX-License-Identifier: Apache-2.0
#include "twin/clock_offset.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "twin/grasps.h"
#include "twin/resampling.h"

namespace physpring {
namespace {

// By the nearest number of frames.
void ShiftHeld(double seconds, Recording* recording) {
  if (recording->held.size() == 0) return;
  const auto held = recording->held;
  const int frames = static_cast<int>(std::lround(seconds * recording->fps));
  for (int t = 0; t < recording->frame_count(); ++t) {
    recording->held.row(t) = held.row(std::clamp(t - frames, 0, recording->frame_count() - 1));
  }
  FindShapesWhenHeld(recording);
}

}  // namespace

void ShiftControllers(double seconds, Recording* recording) {
  if (seconds == 0 || recording->controller_count() == 0) return;
  const FrameGrid grid{0, recording->fps, recording->frame_count()};
  std::vector<double> times;
  for (int t = 0; t < grid.frames; ++t) times.push_back(grid.Time(t) + seconds);
  recording->controllers = ResamplePaths(recording->controllers, times, grid);
  recording->force = ResampleNumbers(recording->force, times, grid);
  ShiftHeld(seconds, recording);
  // those that take hold later stay where that is on the body
  for (int c = 0; c < recording->controller_count(); ++c) {
    if (recording->held.size() > 0 && !recording->held(0, c)) continue;
    const int column = recording->particle_count() + c;
    recording->start.col(column) = recording->controllers[0].col(c);
    if (!recording->rest_given) recording->rest.col(column) = recording->controllers[0].col(c);
  }
}

void UseClockOf(const Twin& twin, Recording* recording) {
  if (twin.clock_offset && recording->two_clocks) ShiftControllers(*twin.clock_offset, recording);
}

Recording ReadRecordingFor(const Twin& twin, const std::string& path) {
  Recording recording = ReadRecording(path);
  UseClockOf(twin, &recording);
  return recording;
}

}  // namespace physpring
