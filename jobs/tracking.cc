// SPDX-License-Identifier: Apache-2.0
#include "jobs/tracking.h"

#include <fmt/format.h>

#include <cmath>

#include "registration/placed_twin.h"
#include "tracker/tracked_body.h"
#include "twin/clock_offset.h"
#include "twin/error.h"

namespace physpring {

Recording RecordingToTrack(const Twin& twin, Recording recording, const TrackOptions& options) {
  UseClockOf(twin, &recording);
  if (recording.point_count() > 0) return recording;
  if (options.cloud) return PlaceTwin(twin, recording);
  throw Error(
      fmt::format("recording {}: has clouds ('surface') and no 'points'; --cloud follows them",
                  recording.name));
}

std::string WarningOfSoftened(double softened) {
  if (softened <= kMostSoftened) return "";
  return fmt::format(
      "so few sub-steps soften {:.0f} % of the springs: the body may be lost, without a word where "
      "clouds are followed",
      100 * softened);
}

std::vector<std::string> WarningsOf(const TrackedMotion& motion) {
  constexpr double kWorse = 1.1;
  const TrackErrors& errors = motion.errors;
  std::vector<std::string> warnings;
  const std::string softened = WarningOfSoftened(motion.softened);
  if (!softened.empty()) warnings.push_back(softened);
  if (motion.cloud && std::isnan(motion.cloud->distance)) {
    warnings.emplace_back("the last second has no cloud: from the last one on, it is predicted");
  } else if (motion.cloud && motion.cloud->distance > motion.cloud->spacing) {
    warnings.push_back(
        fmt::format("it is lost: in the last second the cloud is {:.1f} mm from the nearest nodes, "
                    "which are {:.1f} mm apart",
                    1e3 * motion.cloud->distance, 1e3 * motion.cloud->spacing));
  }
  if (motion.cloud && motion.cloud->distance > kWorse * motion.predicted_cloud_distance) {
    warnings.emplace_back("the prediction without any measurement is nearer to the clouds");
  } else if (motion.cloud && motion.predicted_cloud_distance > motion.cloud->spacing) {
    warnings.push_back(fmt::format(
        "without measurements the twin ends {:.0f} mm from the clouds: it is poor, or clouds and "
        "controllers are not of its object or of one clock; then particles may slide along it",
        1e3 * motion.predicted_cloud_distance));
  }
  if (errors.tracked > kWorse * errors.predicted) {
    warnings.emplace_back("measurements make it worse than the prediction without any");
  }
  if (errors.tracked > kWorse * errors.interpolated) {
    warnings.emplace_back("interpolation without a twin is nearer");
  }
  return warnings;
}

}  // namespace physpring
