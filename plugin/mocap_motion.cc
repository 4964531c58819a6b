// SPDX-License-Identifier: Apache-2.0
#include "plugin/mocap_motion.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace physpring {
namespace {

using Vector = Eigen::Vector3d;

constexpr int kPose = 7;  // numbers of a place and a quaternion

Eigen::Quaterniond Rotation(const double* quat) { return {quat[0], quat[1], quat[2], quat[3]}; }

}  // namespace

MocapMotion::MocapMotion(const mjModel* model) {
  for (int geom = 0; geom < model->ngeom; ++geom) {
    const int body = model->body_weldid[model->geom_bodyid[geom]];
    if (model->body_mocapid[body] < 0) continue;
    if (std::find(bodies_.begin(), bodies_.end(), body) == bodies_.end()) bodies_.push_back(body);
  }
}

int MocapMotion::state_size() const {
  return bodies_.empty() ? 0 : 1 + kPose * static_cast<int>(bodies_.size());
}

Eigen::Matrix<double, 6, 1> MocapMotion::Velocity(const mjModel* model, const mjData* data,
                                                  int body, const double* state) const {
  Eigen::Matrix<double, 6, 1> velocity = Eigen::Matrix<double, 6, 1>::Zero();
  const int root = model->body_weldid[body];
  const auto found = std::find(bodies_.begin(), bodies_.end(), root);
  if (found == bodies_.end() || *state == 0) return velocity;
  const double* before = state + 1 + kPose * (found - bodies_.begin());
  const double *place = data->xpos + 3 * root, *quat = data->xquat + 4 * root;
  if (std::equal(place, place + 3, before) && std::equal(quat, quat + 4, before + 3)) {
    return velocity;
  }
  const Eigen::Quaterniond turn = Rotation(quat) * Rotation(before + 3).conjugate();
  const Eigen::AngleAxisd angle(turn);
  const Vector now = Eigen::Map<const Vector>(data->xipos + 3 * body);
  const Vector then =
      Eigen::Map<const Vector>(before) + turn.conjugate() * (now - Eigen::Map<const Vector>(place));
  velocity << angle.angle() * angle.axis(), now - then;
  return velocity / model->opt.timestep;
}

void MocapMotion::Keep(const mjData* data, double* state) const {
  if (bodies_.empty()) return;
  *state++ = 1;
  for (int body : bodies_) {
    state = std::copy_n(data->xpos + 3 * body, 3, state);
    state = std::copy_n(data->xquat + 4 * body, 4, state);
  }
}

}  // namespace physpring
