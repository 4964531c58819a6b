// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/start_system.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "twin/checks/objects.h"
#include "twin/neighbours.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr double kStartDrag = 2;  // 1/s
constexpr double kStartRestitution = 0.1;
constexpr double kStartFriction = 0.5;
constexpr double kDamping = 0.5;  // damping rate of the fastest mode, relative to its frequency

// The least mean height of a point over kWindow frames in a row, NaN where it is hardly ever seen.
double LeastHeight(const Recording& recording, int point) {
  constexpr int kWindow = 9, kSeen = 5;
  double least = std::numeric_limits<double>::quiet_NaN();
  for (int first = 1; first + kWindow <= recording.train_frames; first += kWindow / 2) {
    double sum = 0;
    int seen = 0;
    for (int frame = first; frame < first + kWindow; ++frame) {
      const auto x = recording.points[frame].col(point);
      if (std::isnan(x[0])) continue;
      sum += recording.ground->head<3>().dot(x) - (*recording.ground)[3];
      ++seen;
    }
    if (seen >= kSeen) least = std::fmin(least, sum / seen);
  }
  return least;
}

// How high the fifth of the points that come lowest lie; 0 where they are hardly ever seen.
double LyingHeight(const Recording& recording) {
  std::vector<double> heights;
  for (int i = 0; i < recording.point_count(); ++i) {
    const double height = LeastHeight(recording, i);
    if (!std::isnan(height)) heights.push_back(height);
  }
  if (heights.empty()) return 0;
  const auto fifth = heights.begin() + static_cast<std::ptrdiff_t>(heights.size()) / 5;
  std::nth_element(heights.begin(), fifth, heights.end());
  return *fifth;
}

// Distance from the ground at which particles touch it: the lowest height in frame 0, if the body
// lies there (lower than the particles' spacing), or the height at which it comes to lie later, if
// that is lower or noise has put frame 0 below the ground; 0 where it does not lie.
double ContactRadius(const Recording& recording) {
  if (!recording.ground) return 0;
  const Points nodes = recording.start.leftCols(recording.particle_count());
  const double lowest =
      (recording.ground->head<3>().transpose() * nodes).minCoeff() - (*recording.ground)[3];
  const std::vector<Neighbour> near = NeighbourSearch(nodes).Nearest(nodes.col(0), 2);
  const double spacing = near.size() > 1 ? near[1].distance : 0;
  const double later = LyingHeight(recording);
  const double height = later > 0 && (later < lowest || lowest < 0) ? later : lowest;
  return height > 0 && height < spacing ? height : 0;
}

// The columns of an object's particles, then of its controllers.
std::vector<int> ColumnsOf(const Recording& recording, int object) {
  std::vector<int> columns;
  for (int i = 0; i < recording.object.size(); ++i) {
    if (recording.object[i] == object) columns.push_back(i);
  }
  return columns;
}

// Springs of the stress-free shape; none from one object to another.
std::vector<std::array<int, 2>> SpringsOf(const Recording& recording,
                                          const TopologyOptions& topology) {
  const int particles = recording.particle_count();
  if (recording.object.size() == 0) {
    return BuildSprings(recording.rest, recording.controller_count(), recording.rod, topology,
                        recording.name);
  }
  std::vector<std::array<int, 2>> all;
  for (int object = 0; object < ObjectCount(recording); ++object) {
    const std::vector<int> columns = ColumnsOf(recording, object);
    const auto controllers =
        std::count_if(columns.begin(), columns.end(), [&](int i) { return i >= particles; });
    for (const auto& [a, b] :
         BuildSprings(recording.rest(Eigen::all, columns), static_cast<int>(controllers),
                      PartOfRod(recording.rod, columns), topology,
                      fmt::format("{}, object {}", recording.name, object))) {
      all.push_back({columns[a], columns[b]});
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace

SpringMassSystem MakeStartSystem(const Recording& recording, const TopologyOptions& topology) {
  SpringMassSystem system;
  const int nodes = recording.particle_count();
  system.position = recording.rest;
  system.controllers = recording.controller_count();
  system.rod = recording.rod;
  system.mass = Eigen::VectorXd::Constant(nodes, recording.mass / nodes);
  system.springs = SpringsOf(recording, topology);
  system.rest_length = SpringLengths(system.springs, recording.rest, recording.rod);
  system.stiffness = system.rest_length.cwiseInverse();
  system.dashpot = Eigen::VectorXd::Ones(system.spring_count());
  system.drag = kStartDrag;
  system.contact.surface.restitution = kStartRestitution;
  system.contact.surface.friction = kStartFriction;
  system.contact_radius = Eigen::VectorXd::Constant(nodes, ContactRadius(recording));
  return system;
}

void ScaleToSubsteps(double frame_time, double substeps, double safety, SpringMassSystem* system) {
  const double h = frame_time / substeps;
  // h / safety is the largest stable sub-step s: s^2 omega^2 + 2 s gamma = 4 (stability.h)
  const double omega = (std::sqrt(4 + kDamping * kDamping) - kDamping) * safety / h;
  const StabilityBound bound = ComputeStabilityBound(*system);
  system->stiffness *= omega * omega / (bound.omega_max * bound.omega_max);
  system->dashpot *= kDamping * omega / bound.gamma_max;
}

}  // namespace physpring
