// SPDX-License-Identifier: Apache-2.0
// Small systems in motion, for physics with a closed form.
#ifndef PHYSPRING_TESTS_SUPPORT_SIMULATION_H_
#define PHYSPRING_TESTS_SUPPORT_SIMULATION_H_

#include <vector>

#include "twin/simulator.h"

namespace physpring {

// Nodes at `position` (3 x (nodes + controllers), controllers last), each of `mass`, without
// springs, drag and contact radius; e = mu = 0.
SpringMassSystem Particles(const Points& position, double mass, int controllers = 0);

void AddSpring(int a, int b, double stiffness, double rest_length, double dashpot,
               SpringMassSystem* system);

Environment Weightless();

// Geoms move on by their velocities for `time` seconds.
void MoveOn(double time, std::vector<Geom>* geoms);

// A system in motion. It starts at its reference configuration.
class Simulation {
 public:
  // A frame has `substeps` sub-steps of h seconds.
  Simulation(const SpringMassSystem& system, const Environment& environment, double h,
             int substeps = 1, bool controller_velocity = true);

  void SetVelocity(const Points& velocity);  // 3 x nodes, m/s

  // Frames in which the controllers move with `controller_velocity` (3 x controllers, m/s), by
  // default not at all, and the geoms with their own velocities.
  void Advance(int frames);
  void Advance(int frames, const Points& controller_velocity);

  Points position() const { return simulator_.Positions(state_); }   // 3 x nodes, m
  Points velocity() const { return simulator_.Velocities(state_); }  // 3 x nodes, m/s
  const NodeStates<double>& state() const { return state_; }

  std::vector<Geom> geoms;  // around the system, where they are now

 private:
  Simulator<double> simulator_;
  Simulator<double>::Workspace workspace_;
  NodeStates<double> state_;
  Points controllers_;
};

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_SIMULATION_H_
