// SPDX-License-Identifier: Apache-2.0
#include "registration/register_clouds.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "registration/cloud_particles.h"
#include "registration/followed_body.h"
#include "twin/error.h"
#include "twin/local_motion.h"
#include "twin/neighbours.h"

namespace physpring {
namespace {

constexpr double kPerSeen = 1.5;       // points, by the points of a cloud
constexpr double kPerSeenOfShape = 3;  // the same where a cloud may show half of the object
constexpr int kMostPerSeen = 4;        // points that may be made, by the points of a cloud
constexpr int kFewestSeen = 8;         // points of the first cloud
constexpr double kRoughPart = 0.6;     // of the points, while the shape is hardly known
constexpr int kFramesOfShape = 40;     // whose clouds are carried back
constexpr int kMostPerPoint = 16;      // carried back, by the points of the rough body
constexpr double kFarFromRough =
    1.5;  // spacings: what is carried back farther away is not the body

// In the middle of all frames that have one. Frame 0 has.
int PointsOfACloud(const std::vector<Points>& clouds) {
  std::vector<int> counts;
  for (const Points& cloud : clouds) {
    if (const auto count = static_cast<int>(PointsOf(cloud).cols()); count > 0) {
      counts.push_back(count);
    }
  }
  const auto middle = counts.begin() + static_cast<std::ptrdiff_t>(counts.size() / 2);
  std::nth_element(counts.begin(), middle, counts.end());
  return *middle;
}

// As many as are asked for; 0: `per_seen` times those of a cloud, kMostMadePoints at most. Throws
// Error where they make no body.
int PointsToMake(const Recording& clouds, int points, double per_seen) {
  ExpectSeen(clouds, kFewestSeen);
  const int seen = PointsOfACloud(clouds.surface);
  if (points == 0) points = std::min(kMostMadePoints, static_cast<int>(per_seen * seen));
  if (points > kMostPerSeen * seen) {
    throw Error(fmt::format(
        "recording {}: its clouds have {} points, which do not tell of {}; expected {} or fewer",
        clouds.name, seen, points, kMostPerSeen * seen));
  }
  ExpectEnough(clouds, points, kFewestSeen);
  return points;
}

// The points of a cloud where they were in frame 0, if they moved along with the particles that are
// nearest to them now.
void CarryBack(const Points& cloud, const Points& now, const Points& start,
               std::vector<Eigen::Vector3d>* carried) {
  const double reach = kFarFromRough * MedianSpacing(start);
  const LocalMotion motion(now, start);
  const NeighbourSearch search_at_start(start);
  const Points points = Thinned(cloud, kMostPerPoint * static_cast<int>(now.cols()));
  for (const auto& point : points.colwise()) {
    const Eigen::Vector3d back = *motion.Move(point);
    if (search_at_start.Nearest(back, 1)[0].distance < reach) carried->push_back(back);
  }
}

// The first frames that are fitted. What comes later has no part in the shape of frame 0.
Recording FramesOfShape(Recording clouds) {
  const int frames = std::min({kFramesOfShape, clouds.train_frames, clouds.frame_count()});
  clouds.surface.resize(static_cast<std::size_t>(frames));
  clouds.points.resize(static_cast<std::size_t>(frames));
  clouds.controllers.resize(static_cast<std::size_t>(frames));
  if (clouds.held.size() > 0) clouds.held.conservativeResize(frames, Eigen::NoChange);
  return clouds;
}

// What the rough body's clouds show together, in frame 0.
Points ShapeOf(const Recording& rough, const std::vector<Points>& position) {
  std::vector<Eigen::Vector3d> carried;
  for (std::size_t t = 0; t < position.size(); ++t) {
    CarryBack(rough.surface[t], position[t], position[0], &carried);
  }
  const auto most = static_cast<std::size_t>(kMostPerPoint * position[0].cols());
  const std::size_t step = std::max<std::size_t>(1, carried.size() / most);
  Points shape(3, static_cast<Eigen::Index>((carried.size() + step - 1) / step));
  for (Eigen::Index i = 0; i < shape.cols(); ++i) {
    shape.col(i) = carried[static_cast<std::size_t>(i) * step];
  }
  return shape;
}

// Throws Error unless the particles are enough for a body.
RegisteredClouds Register(const Recording& recording, int threads) {
  ExpectEnough(recording, recording.point_count(), kFewestSeen);
  return TellPoints(recording, FollowClouds(recording, threads));
}

}  // namespace

void ExpectSeen(const Recording& clouds, int fewest) {
  if (clouds.surface.empty()) {
    throw Error(fmt::format("recording {}: has no clouds ('surface')", clouds.name));
  }
  const Eigen::Index seen = PointsOf(clouds.surface[0]).cols();
  if (seen >= fewest) return;
  throw Error(
      fmt::format("recording {}: array 'surface' has {} points in frame 0, expected {} or more",
                  clouds.name, seen, fewest));
}

void ExpectEnough(const Recording& clouds, int points, int fewest) {
  if (points >= fewest) return;
  throw Error(fmt::format("recording {}: {} points make no body, expected {} or more", clouds.name,
                          points, fewest));
}

RegisteredClouds RegisterClouds(const Recording& clouds, int points, int threads) {
  points = PointsToMake(clouds, points, kPerSeen);
  const int few = std::max(kFewestSeen, static_cast<int>(kRoughPart * points));
  const Points first = PointsOf(clouds.surface[0]), kept = WithoutOutliers(first);
  const Recording rough = FramesOfShape(AtRestInFrame0(clouds, SpreadParticles(kept, few)));
  const Points shape = ShapeOf(rough, FollowClouds(rough, threads));
  RegisteredClouds registered =
      Register(AtRestInFrame0(clouds, SpreadParticles(shape, points)), threads);
  registered.outliers = static_cast<int>(first.cols() - kept.cols());
  return registered;
}

RegisteredClouds RegisterCloudsOn(const Recording& clouds, const Points& surface, int points,
                                  int threads) {
  points = PointsToMake(clouds, points, kPerSeenOfShape);
  return Register(AtRestInFrame0(clouds, SpreadParticles(surface, points)), threads);
}

RegisteredClouds RegisterCloudsLike(const Recording& clouds, const Recording& known, int threads) {
  ExpectSeen(clouds, kFewestSeen);
  Recording recording =
      WithParticles(clouds, CarryOver(known, clouds, threads), known.rest, known.interior_count());
  recording.rest_given = true;
  recording.rod = known.rod;
  return Register(recording, threads);
}

}  // namespace physpring
