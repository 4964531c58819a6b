// SPDX-License-Identifier: Apache-2.0
#include "registration/register_markers.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "registration/cloud_particles.h"
#include "registration/followed_body.h"
#include "registration/name_markers.h"
#include "registration/register_clouds.h"
#include "registration/rod_order.h"
#include "twin/local_motion.h"
#include "twin/neighbours.h"

namespace physpring {
namespace {

// In the markers' spacing: how far a marker is from where it should be at most, and what is one
// place after being carried back.
constexpr double kReach = 0.5, kLeastReach = 0.35, kOnePlace = 0.3;
constexpr double kReachOfError = 6;      // times the mean distance of those found in a frame
constexpr double kOftenEnough = 0.3;     // of the frames, in which a marker is seen
constexpr double kFewestNamed = 0.5;     // of the markers, in a frame after which the reach is kept
constexpr double kSecondsCarried = 0.3;  // whose points are carried back
constexpr int kFewest = 4;               // markers
constexpr int kNearest = 3;              // those around a point, with which it goes along
constexpr int kMostPasses = 5;

// The markers as they are followed, and what of the frames is none of them.
struct Followed {
  Recording recording;               // with points
  std::vector<Points> position;      // T frames of 3 x markers, m: also of the hidden ones
  std::vector<Points> without_name;  // T frames of 3 x points, m
  double distance = 0;               // mean, of points from where their markers were expected, m
};

// Names the points of one frame after the other.
class Naming {
 public:
  explicit Naming(const Points& start)
      : spacing_(MedianSpacing(start)),
        reach_(kReach * spacing_),
        last_(start),
        step_(Points::Zero(3, start.cols())) {}

  // What the frame measures: `cloud` named, NaN where a marker is not found.
  Points Name(const Points& cloud, Points* without_name) {
    const Points points = PointsOf(cloud), expected = last_ + step_;
    const std::vector<int> names = NameMarkers(expected, points, reach_);
    Points named = Points::Constant(3, expected.cols(), std::nan(""));
    std::vector<bool> is_named(static_cast<std::size_t>(points.cols()), false);
    double distance = 0, found = 0;
    for (Eigen::Index i = 0; i < named.cols(); ++i) {
      const int point = names[static_cast<std::size_t>(i)];
      if (point < 0) continue;
      named.col(i) = points.col(point);
      is_named[static_cast<std::size_t>(point)] = true;
      distance += (points.col(point) - expected.col(i)).norm();
      ++found;
    }
    std::vector<Eigen::Index> others;
    for (Eigen::Index j = 0; j < points.cols(); ++j) {
      if (!is_named[static_cast<std::size_t>(j)]) others.push_back(j);
    }
    *without_name = points(Eigen::all, others);
    distance_ += distance;
    found_ += found;
    const double wanted = found < kFewestNamed * static_cast<double>(named.cols())
                              ? 2 * reach_
                              : kReachOfError * distance / found;
    reach_ = std::clamp(wanted, kLeastReach * spacing_, kReach * spacing_);
    return named;
  }

  // Mean of what was found so far from where it was expected, m.
  double distance() const { return found_ > 0 ? distance_ / found_ : 0; }

  // Where the markers are in the frame: as measured, else they went along with those around them.
  Points Moved(const Points& named) {
    Points position = named;
    const LocalMotion motion(last_, named, kNearest);
    for (Eigen::Index i = 0; i < named.cols(); ++i) {
      if (named.col(i).allFinite()) continue;
      position.col(i) = motion.Move(last_.col(i)).value_or(last_.col(i));
    }
    step_ = position - last_;
    last_ = position;
    return position;
  }

 private:
  double spacing_, reach_;
  double distance_ = 0, found_ = 0;
  Points last_, step_;
};

Followed Follow(const Recording& clouds, const Points& markers) {
  Followed followed{AtRestInFrame0(clouds, markers), {markers}, {Points(3, 0)}};
  Naming naming(markers);
  for (int t = 1; t < clouds.frame_count(); ++t) {
    const auto at = static_cast<std::size_t>(t);
    Points& named = followed.recording.points[at];
    named = naming.Name(clouds.surface[at], &followed.without_name.emplace_back());
    followed.position.push_back(naming.Moved(named));
  }
  followed.distance = naming.distance();
  return followed;
}

// How many markers are found in a frame.
double FoundIn(const Followed& followed, std::size_t frame) {
  return static_cast<double>(followed.recording.points[frame].row(0).array().isFinite().count());
}

// RegisteredMarkers::lost_from; a gap at the end is none.
std::optional<int> LostFrom(const Followed& followed) {
  constexpr double kGap = 0.1;  // of the frames
  const std::size_t frames = followed.position.size();
  const double half = kFewestNamed * static_cast<double>(followed.position[0].cols());
  std::size_t last = frames - 1;
  while (last > 0 && FoundIn(followed, last) < half) --last;
  if (static_cast<double>(frames - 1 - last) < kGap * static_cast<double>(frames)) return {};
  return static_cast<int>(last) + 1;
}

// Points of which no two are at one place.
Points Distinct(const Points& points) {
  constexpr double kSame = 1e-6;  // m
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const bool is_new = std::none_of(kept.begin(), kept.end(), [&](Eigen::Index j) {
      return (points.col(i) - points.col(j)).norm() < kSame;
    });
    if (is_new) kept.push_back(i);
  }
  return points(Eigen::all, kept);
}

// The markers of frame 0 that are seen again and again.
std::vector<Eigen::Vector3d> SeenOften(const Followed& followed) {
  std::vector<Eigen::Vector3d> markers;
  const auto& frames = followed.recording.points;
  for (Eigen::Index i = 0; i < frames[0].cols(); ++i) {
    const auto seen = std::count_if(frames.begin() + 1, frames.end(), [i](const Points& points) {
      return points.col(i).allFinite();
    });
    if (static_cast<double>(seen) < kOftenEnough * static_cast<double>(frames.size() - 1)) continue;
    markers.emplace_back(frames[0].col(i));
  }
  return markers;
}

// Adds the places of frame 0 where points without names gather.
void AddGathered(const Followed& followed, double fps, std::vector<Eigen::Vector3d>* markers) {
  const double near = kOnePlace * MedianSpacing(followed.position[0]);
  const auto frames =
      std::min(followed.position.size(), static_cast<std::size_t>(kSecondsCarried * fps) + 1);
  std::vector<Eigen::Vector3d> carried;
  for (std::size_t t = 1; t < frames; ++t) {
    const LocalMotion back(followed.position[t], followed.position[0], kNearest);
    for (const auto& point : followed.without_name[t].colwise()) {
      carried.push_back(*back.Move(point));
    }
  }
  while (!carried.empty()) {
    Points points(3, static_cast<Eigen::Index>(carried.size()));
    for (std::size_t j = 0; j < carried.size(); ++j)
      points.col(static_cast<Eigen::Index>(j)) = carried[j];
    const NeighbourSearch search(points);
    std::vector<Neighbour> most;
    for (const Eigen::Vector3d& centre : carried) {
      std::vector<Neighbour> members = search.Within(centre, near);
      if (members.size() > most.size()) most = std::move(members);
    }
    if (static_cast<double>(most.size()) < kOftenEnough * static_cast<double>(frames - 1)) return;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    std::vector<bool> is_taken(carried.size(), false);
    for (const Neighbour& one : most) {
      mean += points.col(one.index) / static_cast<double>(most.size());
      is_taken[static_cast<std::size_t>(one.index)] = true;
    }
    markers->push_back(mean);
    carried.clear();
    for (std::size_t j = 0; j < is_taken.size(); ++j) {
      if (!is_taken[j]) carried.emplace_back(points.col(static_cast<Eigen::Index>(j)));
    }
  }
}

// Where the markers are in frame 0, by what was followed.
Points MarkersOf(const Followed& followed, double fps) {
  std::vector<Eigen::Vector3d> found = SeenOften(followed);
  AddGathered(followed, fps, &found);
  Points markers(3, static_cast<Eigen::Index>(found.size()));
  for (std::size_t i = 0; i < found.size(); ++i) {
    markers.col(static_cast<Eigen::Index>(i)) = found[i];
  }
  return markers;
}

// The arc lengths of markers and controllers, from the end that is nearer to the first controller.
Eigen::VectorXd OrderOf(const Recording& recording) {
  std::vector<Points> columns;
  for (std::size_t t = 0; t < recording.points.size(); ++t) {
    Points& frame = columns.emplace_back(3, recording.start.cols());
    frame << recording.points[t], recording.controllers[t];
  }
  Eigen::VectorXd order = RodOrder(columns, "recording " + recording.name);
  const Eigen::Index first = recording.controller_count() > 0 ? recording.point_count() : 0;
  const double length = order.maxCoeff();
  if (order[first] > length / 2) order = length - order.array();
  return order;
}

// The markers in their order.
std::vector<Eigen::Index> AlongRod(const Eigen::VectorXd& order, Eigen::Index markers) {
  std::vector<Eigen::Index> sorted(static_cast<std::size_t>(markers));
  std::iota(sorted.begin(), sorted.end(), 0);
  std::sort(sorted.begin(), sorted.end(),
            [&](Eigen::Index a, Eigen::Index b) { return order[a] < order[b]; });
  return sorted;
}

}  // namespace

RegisteredMarkers RegisterMarkers(const Recording& clouds, bool rod) {
  ExpectSeen(clouds, kFewest);
  Points markers = Distinct(PointsOf(clouds.surface[0]));
  ExpectEnough(clouds, static_cast<int>(markers.cols()), kFewest);
  Followed followed = Follow(clouds, markers);
  for (int pass = 1; pass < kMostPasses && !LostFrom(followed); ++pass) {
    const Points found = MarkersOf(followed, clouds.fps);
    ExpectEnough(clouds, static_cast<int>(found.cols()), kFewest);
    if (found.cols() == markers.cols() && found == markers) break;
    markers = found;
    followed = Follow(clouds, markers);
  }
  if (rod && !LostFrom(followed)) {
    markers = markers(Eigen::all, AlongRod(OrderOf(followed.recording), markers.cols())).eval();
    followed = Follow(clouds, markers);
    followed.recording.rod = PlainRod(OrderOf(followed.recording));
  }
  RegisteredMarkers registered;
  registered.distance = followed.distance;
  registered.spacing = MedianSpacing(markers);
  registered.lost_from = LostFrom(followed);
  const double frames = clouds.frame_count() - 1, count = static_cast<double>(markers.cols());
  for (std::size_t t = 1; t < followed.position.size(); ++t) {
    const double found = FoundIn(followed, t);
    const double others = static_cast<double>(followed.without_name[t].cols());
    registered.seen += found / (count * frames);
    registered.without_name += others / frames;
    registered.confused += std::min(others, count - found) / (count * frames);
  }
  registered.recording = std::move(followed.recording);
  return registered;
}

}  // namespace physpring
