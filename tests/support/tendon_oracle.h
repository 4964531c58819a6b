// SPDX-License-Identifier: Apache-2.0
// The same spring-mass system in MuJoCo's own terms, as an oracle for the simulator: nodes are
// bodies with three slide joints, springs are spatial tendons, controllers are mocap bodies.
// Euler's integrator, no contacts. Effects are those that are attributes of a tendon.
//
// MuJoCo takes joint damping c implicitly, v' = (m v + h F) / (m + h c), so that
// c = m (exp(h drag) - 1) / h is exactly the decay exp(-h drag). Mocap bodies have no velocity: the
// oracle's dashpots do not feel that of controllers.
#ifndef PHYSPRING_TESTS_SUPPORT_TENDON_ORACLE_H_
#define PHYSPRING_TESTS_SUPPORT_TENDON_ORACLE_H_

#include <string>

#include "rollout/scene.h"
#include "twin/spring_mass_system.h"

namespace physpring {

// MJCF of the system. `gravity` in m/s^2, `timestep` in s.
std::string TendonMjcf(const SpringMassSystem& system, const Eigen::Vector3d& gravity,
                       double timestep);

class TendonOracle {
 public:
  // At rest in the system's reference configuration. Throws Error when MuJoCo refuses or warns.
  TendonOracle(const SpringMassSystem& system, const Eigen::Vector3d& gravity, double timestep);

  // 3 x nodes, m and m/s.
  void SetState(const Points& position, const Points& velocity);

  // One time step, with the controllers (3 x controllers, m) where they are at its end. Throws
  // Error when MuJoCo warns.
  void Step(const Points& controllers);

  Points Positions() const;   // of the free nodes, 3 x nodes, m
  Points Velocities() const;  // 3 x nodes, m/s

 private:
  Points reference_;  // 3 x nodes, m
  ModelPtr model_;
  DataPtr data_;
};

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_TENDON_ORACLE_H_
