// SPDX-License-Identifier: Apache-2.0
// How mocap bodies that have geoms move. MuJoCo gives them no velocity. As with controllers, the
// pose that is set before a step of length H is where the body stands at its end; it moves there
// evenly from its last pose:
//   velocity of a point p fixed in the body = (p_now - p_before) / H,   turning = angle * axis / H
// The last poses are a part of plugin_state (twin/plugin_state.h). A body whose last pose is not
// known, as after a reset, stands still.
#ifndef PHYSPRING_PLUGIN_MOCAP_MOTION_H_
#define PHYSPRING_PLUGIN_MOCAP_MOTION_H_

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <vector>

namespace physpring {

class MocapMotion {
 public:
  explicit MocapMotion(const mjModel* model);

  // How many numbers of plugin_state it needs: whether poses are known, and 7 a body; 0 without
  // such bodies.
  int state_size() const;

  // The velocity of a body that is a mocap body, or is fixed in one: first the angular part, then
  // that of its centre of mass, in the world's axes [rad/s, m/s]. Exactly 0 if it stands still.
  Eigen::Matrix<double, 6, 1> Velocity(const mjModel* model, const mjData* data, int body,
                                       const double* state) const;

  // Takes the present poses as the last ones.
  void Keep(const mjData* data, double* state) const;

 private:
  std::vector<int> bodies_;  // mocap bodies that have geoms
};

}  // namespace physpring

#endif  // PHYSPRING_PLUGIN_MOCAP_MOTION_H_
