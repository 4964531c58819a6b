// SPDX-License-Identifier: Apache-2.0
#include "jobs/tracking.h"

#include <fmt/format.h>

namespace physpring {

std::vector<std::string> WarningsOf(const TrackedMotion& motion) {
  constexpr double kWorse = 1.1;
  const TrackErrors& errors = motion.errors;
  std::vector<std::string> warnings;
  if (motion.cloud.distance > motion.cloud.spacing) {
    warnings.push_back(
        fmt::format("it is lost: in the last second the cloud is {:.1f} mm from the nearest nodes, "
                    "which are {:.1f} mm apart",
                    1e3 * motion.cloud.distance, 1e3 * motion.cloud.spacing));
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
