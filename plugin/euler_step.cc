// SPDX-License-Identifier: Apache-2.0
#include "plugin/euler_step.h"

namespace physpring {

EulerStep::EulerStep(const mjModel* model)
    : model_(model), time_(model->opt.timestep), gravity_(Eigen::Vector3d::Zero()) {
  const int disabled = model->opt.disableflags;
  if ((disabled & mjDSBL_GRAVITY) == 0) {
    gravity_ = Eigen::Map<const Eigen::Vector3d>(model->opt.gravity);
  }
  damped_ = (disabled & mjDSBL_DAMPER) == 0;
  implicit_ = model->opt.integrator != mjINT_EULER || (disabled & mjDSBL_EULERDAMP) == 0;
}

Eigen::Vector3d EulerStep::Velocity(const mjData* data, int dof, int joint) const {
  return JointAxes(data, joint) * Eigen::Map<const Eigen::Vector3d>(data->qvel + dof);
}

Eigen::Vector3d EulerStep::NextVelocity(const mjData* data, int dof, int joint, double mass) const {
  const Axes axes = JointAxes(data, joint);
  Eigen::Vector3d velocity;  // along the joints
  for (int j = 0; j < 3; ++j) {
    const double force = data->qfrc_passive[dof + j] + mass * axes.col(j).dot(gravity_);
    velocity[j] = data->qvel[dof + j] + time_ * force / Inertia(dof + j, mass);
  }
  return axes * velocity;
}

void EulerStep::AddChange(const Eigen::Vector3d& change, int dof, int joint, double mass,
                          mjData* data) const {
  const Axes axes = JointAxes(data, joint);
  for (int j = 0; j < 3; ++j) {
    data->qfrc_passive[dof + j] += Inertia(dof + j, mass) * axes.col(j).dot(change) / time_;
  }
}

void EulerStep::AddForceTo(const Eigen::Vector3d& velocity, int dof, int joint, double mass,
                           mjData* data) const {
  const Axes axes = JointAxes(data, joint);
  for (int j = 0; j < 3; ++j) {
    const double v = data->qvel[dof + j];
    const double change = axes.col(j).dot(velocity) - v;
    data->qfrc_passive[dof + j] += Inertia(dof + j, mass) * change / time_ + Damping(dof + j) * v -
                                   mass * axes.col(j).dot(gravity_);
  }
}

}  // namespace physpring
