// SPDX-License-Identifier: Apache-2.0
#include "tests/support/simulation.h"

#include <Eigen/Geometry>

namespace physpring {
namespace {

void Append(double value, Eigen::VectorXd* values) {
  values->conservativeResize(values->size() + 1);
  (*values)[values->size() - 1] = value;
}

}  // namespace

SpringMassSystem Particles(const Points& position, double mass, int controllers) {
  SpringMassSystem system;
  system.position = position;
  system.controllers = controllers;
  system.mass = Eigen::VectorXd::Constant(system.node_count(), mass);
  system.contact_radius = Eigen::VectorXd::Zero(system.node_count());
  system.contact = {{0, 0}, {0, 0}, 0};
  return system;
}

void AddSpring(int a, int b, double stiffness, double rest_length, double dashpot,
               SpringMassSystem* system) {
  system->springs.push_back({a, b});
  Append(stiffness, &system->stiffness);
  Append(rest_length, &system->rest_length);
  Append(dashpot, &system->dashpot);
}

Environment Weightless() { return {.gravity = Eigen::Vector3d::Zero(), .ground = {}}; }

void MoveOn(double time, std::vector<Geom>* geoms) {
  for (Geom& geom : *geoms) {
    geom.position += time * geom.velocity;
    const double angle = time * geom.angular_velocity.norm();
    if (angle == 0) continue;
    geom.rotation = Eigen::AngleAxisd(angle, geom.angular_velocity.normalized()) * geom.rotation;
  }
}

Simulation::Simulation(const SpringMassSystem& system, const Environment& environment, double h,
                       int substeps, bool controller_velocity)
    : simulator_(system, environment,
                 {.frame_time = h * substeps,
                  .substeps = substeps,
                  .controller_velocity = controller_velocity}),
      workspace_(simulator_),
      controllers_(system.position.rightCols(system.controllers)) {
  const Points position = system.position.leftCols(system.node_count());
  state_ = simulator_.MakeState(position, Points::Zero(3, position.cols()));
}

void Simulation::SetVelocity(const Points& velocity) {
  state_ = simulator_.MakeState(position(), velocity);
}

void Simulation::Advance(int frames) { Advance(frames, Points::Zero(3, controllers_.cols())); }

void Simulation::Advance(int frames, const Points& controller_velocity) {
  const double frame_time = simulator_.options().frame_time;
  for (int frame = 0; frame < frames; ++frame) {
    const Points end = controllers_ + frame_time * controller_velocity;
    simulator_.AdvanceFrame({controllers_, end, geoms}, &state_, &workspace_);
    controllers_ = end;
    MoveOn(frame_time, &geoms);
  }
}

}  // namespace physpring
