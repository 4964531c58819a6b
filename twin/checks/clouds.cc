// SPDX-License-Identifier: Apache-2.0
#include "twin/checks/clouds.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "twin/checks/motion_scale.h"
#include "twin/checks/plausibility.h"

namespace physpring {
namespace {

constexpr double kFalse = 0.05;  // of a cloud's points may be false, at either end of each axis
constexpr double kBelowGround = 0.1, kFarGrasp = 0.75;  // sizes of the cloud

bool IsPoint(const Points& cloud, Eigen::Index i) { return cloud.col(i).allFinite(); }

// Along an axis of any length, the part of the cloud's points that lie lower.
double Along(const Points& cloud, const Eigen::Vector3d& axis, double part) {
  std::vector<double> values;
  for (Eigen::Index i = 0; i < cloud.cols(); ++i) {
    if (IsPoint(cloud, i)) values.push_back(axis.dot(cloud.col(i)));
  }
  return Quantile(part, std::move(values));
}

// Diagonal of the box around nearly all of its points, m.
double SizeOf(const Points& cloud) {
  Eigen::Vector3d extent;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
    extent[axis] = Along(cloud, unit, 1 - kFalse) - Along(cloud, unit, kFalse);
  }
  return extent.norm();
}

double DistanceTo(const Points& cloud, const Eigen::Vector3d& place) {
  double nearest = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < cloud.cols(); ++i) {
    if (IsPoint(cloud, i)) nearest = std::min(nearest, (cloud.col(i) - place).norm());
  }
  return nearest;
}

int FramesWithoutPoints(const std::vector<Points>& clouds) {
  return static_cast<int>(std::count_if(clouds.begin(), clouds.end(), [](const Points& cloud) {
    return !cloud.array().isFinite().any();
  }));
}

// Frames whose cloud is exactly the one before, while hands move.
std::vector<int> RepeatedClouds(const Recording& recording) {
  std::vector<int> frames;
  for (int t = 1; t < static_cast<int>(recording.surface.size()); ++t) {
    const auto now = static_cast<std::size_t>(t);
    const Points &cloud = recording.surface[now], &before = recording.surface[now - 1];
    const bool is_same =
        cloud.cols() == before.cols() && cloud.array().isFinite().any() &&
        (cloud.array() == before.array() || (cloud.array().isNaN() && before.array().isNaN()))
            .all();
    if (is_same && recording.controllers[now] != recording.controllers[now - 1]) {
      frames.push_back(t);
    }
  }
  return frames;
}

using Place = std::array<double, 3>;
constexpr Place kOrigin{0, 0, 0};

Place PlaceOf(const Points& cloud, Eigen::Index i) {
  return {cloud(0, i), cloud(1, i), cloud(2, i)};
}

// Where a cloud has more points than can be, to the last bit.
std::set<Place> CrowdedPlaces(const Points& cloud) {
  constexpr int kMany = 3, kManyAtOrigin = 2;
  std::vector<Place> places;
  for (Eigen::Index i = 0; i < cloud.cols(); ++i) {
    if (IsPoint(cloud, i)) places.push_back(PlaceOf(cloud, i));
  }
  std::sort(places.begin(), places.end());
  std::set<Place> crowded;
  for (auto first = places.begin(); first != places.end();) {
    const auto end = std::upper_bound(first, places.end(), *first);
    if (end - first >= (*first == kOrigin ? kManyAtOrigin : kMany)) crowded.insert(*first);
    first = end;
  }
  return crowded;
}

}  // namespace

std::string TakeFillingAsNone(const std::string& where, std::vector<Points>* clouds) {
  std::map<Place, int> crowded;  // in so many frames there are several points
  for (const Points& cloud : *clouds) {
    for (const Place& place : CrowdedPlaces(cloud)) ++crowded[place];
  }
  if (crowded.empty()) return "";
  std::optional<Place> filling;
  int filled = 0, again = 0;
  for (Points& cloud : *clouds) {
    std::set<Place> there;
    for (Eigen::Index i = 0; i < cloud.cols(); ++i) {
      if (!IsPoint(cloud, i)) continue;
      const Place place = PlaceOf(cloud, i);
      const auto found = crowded.find(place);
      if (found == crowded.end()) continue;
      const bool fills = found->second > 1 || place == kOrigin;
      if (!fills && there.insert(place).second) continue;
      cloud.col(i).setConstant(std::numeric_limits<double>::quiet_NaN());
      if (fills) filling = place;
      ++(fills ? filled : again);
    }
  }
  std::string line;
  if (filling) {
    line = fmt::format("{} points are exactly at ({:g}, {:g}, {:g}), taken as none", filled,
                       (*filling)[0], (*filling)[1], (*filling)[2]);
  }
  if (again > 0) {
    line += fmt::format("{}{} points are there more than once in a frame, taken once",
                        line.empty() ? "" : "; ", again);
  }
  return where + ": " + line;
}

std::vector<std::string> FindOddClouds(const Recording& recording) {
  std::vector<std::string> lines;
  const int without = FramesWithoutPoints(recording.surface);
  if (without > 0) {
    lines.push_back(
        fmt::format("{} of {} frames have no cloud", without, recording.surface.size()));
  }
  constexpr std::size_t kFewestRepeated = 3;
  const std::vector<int> repeated = RepeatedClouds(recording);
  if (repeated.size() >= kFewestRepeated) {
    lines.push_back(
        fmt::format("{} frames, the first is {}, have exactly the cloud of the frame before, while "
                    "controllers move: did the camera stop, or were frames recorded twice?",
                    repeated.size(), repeated[0]));
  }
  const Points& first = recording.surface[0];
  if (!first.array().isFinite().any()) return lines;
  const double size = SizeOf(first);
  if (size > kLargestObject || size < kSmallestObject) {
    lines.push_back(
        fmt::format("the first cloud measures {:.3g} m: are positions in metres?", size));
  }
  if (recording.ground) {
    const double height =
        Along(first, recording.ground->head<3>(), kFalse) - (*recording.ground)[3];
    if (height < -kBelowGround * size) {
      lines.push_back(fmt::format("the object starts {:.3g} m below the ground", -height));
    }
  }
  double farthest = 0;
  for (const auto& hand : recording.controllers[0].colwise()) {
    farthest = std::max(farthest, DistanceTo(first, hand));
  }
  if (farthest > kFarGrasp * size) {
    lines.push_back(fmt::format(
        "a controller is {:.3g} m from the first cloud, which measures {:.3g} m: are both in the "
        "same coordinates?",
        farthest, size));
  }
  return lines;
}

}  // namespace physpring
