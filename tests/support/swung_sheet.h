// SPDX-License-Identifier: Apache-2.0
// A small sheet that hangs from a hand at a corner and is swung: the springs of its net fall into
// classes of length, of which the object itself may have only the shortest.
#ifndef PHYSPRING_TESTS_SUPPORT_SWUNG_SHEET_H_
#define PHYSPRING_TESTS_SUPPORT_SWUNG_SHEET_H_

#include <cmath>

#include "tests/support/swung_rope.h"

namespace physpring {

constexpr double kSheetSpacing = 0.02;  // m
constexpr int kSheetColumns = 6, kSheetRows = 5;

inline Recording SwungSheet(int frames) {
  constexpr int kParticles = kSheetColumns * kSheetRows;
  Recording recording = SwungRope(kParticles, frames);
  for (int i = 0; i < kParticles; ++i) {
    const int row = i / kSheetColumns;
    recording.start.col(i) = kSheetSpacing * Eigen::Vector3d(i % kSheetColumns, 0, -row);
  }
  recording.start.col(kParticles) = Eigen::Vector3d(0, 0, kSheetSpacing);
  recording.rest = recording.start;
  for (int t = 0; t < frames; ++t) {
    recording.points[t] = recording.start.leftCols(kParticles);
    recording.controllers[t] = recording.start.rightCols(1);
    recording.controllers[t](0, 0) += 0.03 * std::sin(12 * t / recording.fps);
    recording.controllers[t](1, 0) += 0.03 * std::sin(9 * t / recording.fps);
  }
  return recording;
}

// The sheet's particles, each moved by some part of their spacing: an irregular mesh.
inline Recording Jittered(Recording recording, double part) {
  for (int i = 0; i < recording.particle_count(); ++i) {
    const Eigen::Vector3d moved =
        part * kSheetSpacing * Eigen::Vector3d(std::sin(7 * i), 0, std::cos(9 * i));
    recording.start.col(i) += moved;
    for (auto& frame : recording.points) frame.col(i) += moved;
  }
  recording.rest = recording.start;
  return recording;
}

// The system without its springs of this length and longer ones.
inline SpringMassSystem OnlyShorter(SpringMassSystem system, double length) {
  int kept = 0;
  for (int e = 0; e < system.spring_count(); ++e) {
    if (system.rest_length[e] >= length) continue;
    system.springs[kept] = system.springs[e];
    system.stiffness[kept] = system.stiffness[e];
    system.rest_length[kept] = system.rest_length[e];
    system.dashpot[kept++] = system.dashpot[e];
  }
  system.springs.resize(kept);
  system.stiffness.conservativeResize(kept);
  system.rest_length.conservativeResize(kept);
  system.dashpot.conservativeResize(kept);
  return system;
}

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_SWUNG_SHEET_H_
