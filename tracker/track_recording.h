// SPDX-License-Identifier: Apache-2.0
// The state of a twin in each frame of a recording, from what of it is seen there, and how far it
// is off where somebody knows better.
#ifndef PHYSPRING_TRACKER_TRACK_RECORDING_H_
#define PHYSPRING_TRACKER_TRACK_RECORDING_H_

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

struct TrackOptions {
  bool cloud = false;      // follow the recording's `surface` and not its points
  double hide = 0;         // this part of the points is not told, and judged by: 0 to 1, not 1
  std::uint64_t seed = 1;  // which points are hidden
  int substeps = 0;        // a frame (tracked_body.h); 0: as many as it takes
};

// Mean distances from the points that are judged by, m, over all frames after frame 0 in which they
// were measured; NaN where there are none.
struct TrackErrors {
  double tracked;       // of the state
  double predicted;     // of the twin's motion from frame 0 on, without any measurement
  double interpolated;  // of points that go along with the nearest ones that are told, by no twin
};

// Where clouds were in the last second, from the nodes that should be in them.
struct CloudFit {
  double distance = 0;  // as UsualDistance of its points to their nearest node, m
  double spacing = 0;   // of the nodes, m
};

struct TrackedMotion {
  std::vector<Points> position;  // T frames of 3 x particles, m
  std::vector<Points> velocity;  // T frames of 3 x particles, m/s
  std::vector<int> hidden;       // the points that were not told, and judged by
  TrackErrors errors;
  std::optional<CloudFit> cloud;  // of clouds that were followed
  // The same distance of the twin's motion from frame 0 on, without any measurement, m; NaN without
  // clouds, and where that motion diverges.
  double predicted_cloud_distance = std::numeric_limits<double>::quiet_NaN();
  int substeps = 0;              // a frame
  double softened = 0;           // the part of the springs that are (tracked_body.h)
  double frames_per_second = 0;  // of processor time, by one thread
};

// How far each point of a cloud is from the nearest of `nodes` (3 x nodes), m; columns of NaN are
// no points.
std::vector<double> DistancesToNearest(const Points& nodes, const Points& cloud);

// The mean of the nearest four fifths of them: the others may be false points. NaN without any.
double UsualDistance(std::vector<double> distances);

// Of particles that are at `position`, T frames of 3 x particles, m, in the recording's clouds.
CloudFit FitOfClouds(const std::vector<Points>& position, const Recording& recording);

// Level 0 of the twin. Throws Error where the recording does not fit the twin, where it has nothing
// to follow, and where the motion diverges.
TrackedMotion TrackRecording(const Twin& twin, const Recording& recording,
                             const TrackOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_TRACKER_TRACK_RECORDING_H_
