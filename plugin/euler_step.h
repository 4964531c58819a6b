// SPDX-License-Identifier: Apache-2.0
// MuJoCo's step of a node's dof, and the passive force that makes it land on a wanted velocity.
// With mass m, joint damping c (taken implicitly), gravity g along the joint and a passive force f
//   v' = v + H (f - c v + m g) / (m + H c),   x' = x + H v'
// Exact for the integrators Euler, implicit and implicitfast, because no force that MuJoCo
// differentiates couples the dofs of nodes (tendons' dashpots do under the implicit ones).
#ifndef PHYSPRING_PLUGIN_EULER_STEP_H_
#define PHYSPRING_PLUGIN_EULER_STEP_H_

#include <mujoco/mujoco.h>

#include <Eigen/Core>

namespace physpring {

class EulerStep {
 public:
  explicit EulerStep(const mjModel* model);

  double time() const { return time_; }                        // H, s
  const Eigen::Vector3d& gravity() const { return gravity_; }  // m/s^2, 0 where disabled

  // Velocity of the node whose first dof and joint are given, in the world's axes [m/s].
  Eigen::Vector3d Velocity(const mjData* data, int dof, int joint) const;

  // The velocity that it will have after the step by the passive forces so far.
  Eigen::Vector3d NextVelocity(const mjData* data, int dof, int joint, double mass) const;

  // Adds the passive force that changes the velocity after the step by `change` [m/s].
  void AddChange(const Eigen::Vector3d& change, int dof, int joint, double mass,
                 mjData* data) const;

  // Adds the passive force that makes it `velocity`, whatever damping and gravity do.
  void AddForceTo(const Eigen::Vector3d& velocity, int dof, int joint, double mass,
                  mjData* data) const;

 private:
  using Axes =
      Eigen::Map<const Eigen::Matrix3d>;  // each column is the axis of one of a node's joints
  static Axes JointAxes(const mjData* data, int joint) { return Axes(data->xaxis + 3 * joint); }
  double Damping(int dof) const { return damped_ ? model_->dof_damping[dof] : 0; }
  double Inertia(int dof, double mass) const {
    return mass + (implicit_ ? time_ * Damping(dof) : 0);
  }

  const mjModel* model_;
  double time_;
  Eigen::Vector3d gravity_;
  bool damped_, implicit_;
};

}  // namespace physpring

#endif  // PHYSPRING_PLUGIN_EULER_STEP_H_
