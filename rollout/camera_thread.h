// SPDX-License-Identifier: Apache-2.0
// The cameras of one episode, in a thread of their own: pictures are drawn while the simulation
// goes on. Only what moves is handed over; the thread has mjData of its own.
#ifndef PHYSPRING_ROLLOUT_CAMERA_THREAD_H_
#define PHYSPRING_ROLLOUT_CAMERA_THREAD_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rollout/episode.h"
#include "rollout/painter.h"

namespace physpring {

struct CameraOptions {
  PictureQuality quality = PictureQuality::kFast;
  std::string video;                     // file; empty: none
  std::vector<std::string> video_shows;  // cameras, side by side; empty: the task's first one
  std::optional<std::uint64_t> looks = std::nullopt;  // drawn from this seed (looks.h)
};

// Throws Error where OSMesa or ffmpeg are missing, and for cameras that the scene does not have.
// What goes wrong later is thrown by Show, Look or Finish.
std::unique_ptr<Viewer> MakeCameraThread(const TaskModel& model, const CameraOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_CAMERA_THREAD_H_
