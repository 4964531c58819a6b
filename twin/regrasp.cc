// SPDX-License-Identifier: Apache-2.0
#include "twin/regrasp.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "twin/column_names.h"
#include "twin/hierarchy.h"
#include "twin/local_motion.h"
#include "twin/neighbours.h"
#include "twin/recorded_rod.h"

namespace physpring {
namespace {

constexpr double kSamePlace = 0.5;        // of the particles' spacing
constexpr double kShortestSpring = 1e-3;  // of it

void MoveGrasp(const MovedGrasp& moved, double shortest, SpringMassSystem* system) {
  const int nodes = system->node_count(), column = nodes + moved.controller;
  system->position.col(column) = moved.place;
  std::vector<int> springs;  // the shortest one first
  for (int e = 0; e < system->spring_count(); ++e) {
    if (std::max(system->springs[e][0], system->springs[e][1]) == column) springs.push_back(e);
  }
  std::stable_sort(springs.begin(), springs.end(),
                   [&](int a, int b) { return system->rest_length[a] < system->rest_length[b]; });
  const Points position = system->position.leftCols(nodes);
  const std::vector<Neighbour> nearest =
      NeighbourSearch(position).Nearest(moved.place, static_cast<int>(springs.size()));
  for (std::size_t i = 0; i < springs.size(); ++i) {
    system->springs[springs[i]] = {static_cast<int>(nearest[i].index), column};
    system->rest_length[springs[i]] = std::max(nearest[i].distance, shortest);
  }
}

// A controller that holds elsewhere is where the recording says, if it knows the same rod; else it
// is no part of the rod.
void MoveOnRod(const Recording& recording, int column, Rod* rod) {
  if (recording.rod.arc.size() == rod->arc.size()) {
    *rod = recording.rod;
  } else {
    TakeOut(column, rod);
  }
}

// Whether a controller is as far from the particles that are nearest to it in the reference as it
// is there. However the body starts, these distances hardly change.
bool HoldsTheSame(const Eigen::Vector3d& place, const Points& start, const Eigen::Vector3d& known,
                  const NeighbourSearch& search, double spacing) {
  constexpr int kNearest = 3;
  double change = 0, count = 0;
  for (const Neighbour& one : search.Nearest(known, kNearest)) {
    change += std::abs((place - start.col(one.index)).norm() - one.distance);
    ++count;
  }
  return change < kSamePlace * spacing * count;
}

}  // namespace

std::vector<MovedGrasp> FindMovedGrasps(const Points& reference, const Recording& recording) {
  std::vector<MovedGrasp> moved;
  const int particles = recording.particle_count();
  const Points shape = reference.leftCols(particles), start = recording.start.leftCols(particles);
  if (particles < 2) return moved;
  const double spacing = MedianSpacing(shape);
  const LocalMotion motion(start, shape);
  const NeighbourSearch search(shape);
  for (int c = 0; c < recording.controller_count(); ++c) {
    const Eigen::Vector3d place = recording.start.col(particles + c);
    const Eigen::Vector3d known = reference.col(particles + c);
    if (HoldsTheSame(place, start, known, search, spacing)) continue;
    const Eigen::Vector3d there = *motion.Move(place);
    moved.push_back({c, there, (there - known).norm()});
  }
  return moved;
}

void MoveGrasps(const std::vector<MovedGrasp>& moved, const Recording& recording, Twin* twin) {
  const int particles = recording.particle_count();
  const double spacing = MedianSpacing(Points(twin->levels[0].system.position.leftCols(particles)));
  for (const MovedGrasp& one : moved) {
    const int column = particles + one.controller;
    if (!twin->rod.empty()) MoveOnRod(recording, column, &twin->rod);
    for (TwinLevel& level : twin->levels) {
      MoveGrasp(one, kShortestSpring * spacing, &level.system);
    }
  }
  SpreadRod(twin);
}

Twin HeldAsIn(Recording* recording, Twin twin) {
  if (twin.TrainingOn(recording->hash)) return twin;
  const auto moved = FindMovedGrasps(twin.levels[0].system.position, *recording);
  MoveGrasps(moved, *recording, &twin);
  if (recording->held.size() > 0) {
    KeepHoldingControllers(*recording, &twin.rod);
    SpreadRod(&twin);
  }
  for (const MovedGrasp& one : moved) {
    recording->notes.push_back(
        fmt::format("recording {}: {} holds the object {:.3g} m from where it held it in the "
                    "training; its springs hold the nodes that are near it there",
                    recording->name, NameOfController(*recording, one.controller), one.distance));
  }
  return twin;
}

}  // namespace physpring
