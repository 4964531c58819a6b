// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/phystwin_variables.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cassert>
#include <vector>

#include "trainer/bodies/start_system.h"
#include "twin/neighbours.h"

namespace physpring {
namespace {

struct Range {
  double low, high, start;
  bool is_length = false;
};

// In the order of PhysTwinVariables.
constexpr std::array<Range, kPhysTwinVariables> kRanges = {{
    {0, kPhysTwinLargestY, 3e4},
    {0.01, 0.05, 0.02, true},
    {10, 50, 30},
    {0.01, 0.08, 0.04, true},
    {10, 80, 50},
    {0, 1, 0.5},
    {0, 2, 0.3},
    {0, 1, 0.7},
    {0, 2, 0.3},
    {0.01, 0.05, 0.02, true},
    {0, 20, 3},
    {0, 200, 100},
}};

// Cut to a whole number, whatever rounding did to one.
int Count(double value) { return static_cast<int>(value + 1e-9); }

}  // namespace

PhysTwinVariables FromUnitCube(const Eigen::VectorXd& point, double length_scale) {
  assert(point.size() == kPhysTwinVariables);
  std::array<double, kPhysTwinVariables> value;
  for (int i = 0; i < kPhysTwinVariables; ++i) {
    const Range& range = kRanges[i];
    value[i] = range.low + point[i] * (range.high - range.low);
    if (range.is_length) value[i] *= length_scale;
  }
  return {.spring_y = value[0],
          .object_radius = value[1],
          .object_neighbours = Count(value[2]),
          .controller_radius = value[3],
          .controller_neighbours = Count(value[4]),
          .restitution = value[5],
          .friction = value[6],
          .object_restitution = value[7],
          .object_friction = value[8],
          .collision_distance = value[9],
          .drag = value[10],
          .dashpot = value[11]};
}

Eigen::VectorXd PhysTwinStart() {
  Eigen::VectorXd point(kPhysTwinVariables);
  for (int i = 0; i < kPhysTwinVariables; ++i) {
    point[i] = (kRanges[i].start - kRanges[i].low) / (kRanges[i].high - kRanges[i].low);
  }
  return point;
}

double PhysTwinLengthScale(const Recording& recording) {
  const Points particles = recording.rest.leftCols(recording.particle_count());
  if (particles.cols() < 2) return 1;
  return std::max(1.0, MedianSpacing(particles) / kPhysTwinSpacing);
}

int PhysTwinPasses(const Recording& recording) {
  constexpr int kPasses = 200, kSheetPasses = 100;
  if (recording.interior_count() > 0) return kPasses;
  const Points particles = recording.rest.leftCols(recording.particle_count());
  const Points centred = particles.colwise() - particles.rowwise().mean();
  const Eigen::Matrix3d covariance =
      centred * centred.transpose() / static_cast<double>(centred.cols());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance, Eigen::EigenvaluesOnly);
  const Eigen::Vector3d deviation = eigen.eigenvalues().cwiseMax(0).cwiseSqrt();  // ascending
  const double spacing = PhysTwinLengthScale(recording) * kPhysTwinSpacing;
  return deviation[0] < 0.5 * spacing && deviation[1] > 2 * spacing ? kSheetPasses : kPasses;
}

SpringMassSystem MakePhysTwinSystem(const Recording& recording, const PhysTwinVariables& variables,
                                    bool self_collision) {
  TopologyOptions topology;
  topology.radius = variables.object_radius;
  topology.max_neighbours = variables.object_neighbours - 1;
  topology.controller_radius = variables.controller_radius;
  topology.controller_max_neighbours = variables.controller_neighbours;
  SpringMassSystem system = MakeStartSystem(recording, topology);
  const double mass = system.mass[0];  // all particles weigh the same
  system.stiffness = variables.spring_y * mass * system.rest_length.cwiseInverse();
  system.dashpot.setConstant(variables.dashpot * mass);
  system.drag = variables.drag;
  system.contact.surface.restitution = variables.restitution;
  system.contact.surface.friction = variables.friction;
  system.contact.object.restitution = variables.object_restitution;
  system.contact.object.friction = variables.object_friction;
  system.contact.collision_distance = self_collision ? variables.collision_distance : 0;
  return system;
}

}  // namespace physpring
