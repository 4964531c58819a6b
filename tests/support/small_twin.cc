// SPDX-License-Identifier: Apache-2.0
#include "tests/support/small_twin.h"

#include <cmath>

#include "twin/hierarchy.h"
#include "twin/predict.h"
#include "twin/topology.h"

namespace physpring {
namespace {

constexpr int kParticles = 40, kControllers = 2;
constexpr double kSpacing = 0.02;  // m

SpringMassSystem MakeSystem(const Points& position, const Eigen::VectorXd& mass) {
  SpringMassSystem system;
  system.position = position;
  system.controllers = kControllers;
  system.mass = mass;
  TopologyOptions topology;
  topology.max_neighbours = 8;
  topology.controller_max_neighbours = 4;
  system.springs = BuildSprings(position, kControllers, {}, topology, "small twin");
  system.rest_length = SpringLengths(system.springs, position, {});
  system.stiffness = Eigen::VectorXd::Constant(system.spring_count(), 60);
  system.dashpot = Eigen::VectorXd::Constant(system.spring_count(), 0.05);
  system.drag = 1;
  system.contact_radius = Eigen::VectorXd::Constant(mass.size(), 0.005);
  return system;
}

// Particle (x, y, z) of the block is number (z * 4 + y) * 5 + x.
SpringMassSystem MakeBlock() {
  Points position(3, kParticles + kControllers);
  Eigen::VectorXd mass(kParticles);
  for (int i = 0; i < kParticles; ++i) {
    position.col(i) = kSpacing * Eigen::Vector3i(i % 5, i / 5 % 4, i / 20).cast<double>();
    mass[i] = 0.002 + 0.001 * (i % 2);
  }
  position.col(kParticles) = kSpacing * Eigen::Vector3d(0.5, 1.5, 2);
  position.col(kParticles + 1) = kSpacing * Eigen::Vector3d(3.5, 1.5, 2);
  return MakeSystem(position, mass);
}

// Level 1: the particles of a column; level 2: neighbours in y of those.
TwinLevel Coarsen(const Twin& twin) {
  const SpringMassSystem& fine = twin.levels.back().system;
  TwinLevel level;
  for (int i = 0; i < fine.node_count(); ++i) {
    level.assignment.push_back(twin.levels.size() == 1 ? i % 20 : i / 10 * 5 + i % 5);
  }
  const int nodes = fine.node_count() / 2;
  Points position = Points::Zero(3, nodes + kControllers);
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(nodes);
  for (int i = 0; i < fine.node_count(); ++i) {
    position.col(level.assignment[i]) += fine.mass[i] * fine.position.col(i);
    mass[level.assignment[i]] += fine.mass[i];
  }
  for (int i = 0; i < nodes; ++i) position.col(i) /= mass[i];
  position.rightCols(kControllers) = fine.position.rightCols(kControllers);
  level.system = MakeSystem(position, mass);
  level.substeps_per_second = 1000;
  return level;
}

}  // namespace

Twin SmallTwin(int levels) {
  Twin twin;
  twin.name = "block";
  twin.levels.push_back({MakeBlock(), {}, 1000});
  twin.points = 32;
  twin.interior = 8;
  twin.fps = 50;
  while (static_cast<int>(twin.levels.size()) < levels) twin.levels.push_back(Coarsen(twin));
  return twin;
}

Recording RecordingOfMotion(const Twin& twin, int frames) {
  const SpringMassSystem& system = twin.levels[0].system;
  Recording recording;
  recording.name = "swing";
  recording.fps = 50;
  recording.mass = system.mass.sum();
  recording.start = system.position;
  recording.rest = system.position;
  recording.interior = system.position.middleCols(twin.points, twin.interior);
  recording.velocity = Points::Zero(3, system.node_count());
  recording.train_frames = frames * 7 / 10;
  for (int t = 0; t < frames; ++t) {
    recording.points.emplace_back(system.position.leftCols(twin.points));
    recording.controllers.emplace_back(system.position.rightCols(kControllers));
    recording.controllers[t].row(0).array() += 0.05 * std::sin(t / recording.fps * 8);
  }
  const std::vector<Points> motion = Predict(twin, 0, recording, {});
  for (int t = 0; t < frames; ++t) recording.points[t] = motion[t].leftCols(twin.points);
  return recording;
}

}  // namespace physpring
