// SPDX-License-Identifier: Apache-2.0
// Which vertices of a scene's flex are measured, unseen or held.
//
//   controllers  vertices whose body is, or hangs rigidly on, a mocap body or the world, and
//                vertices tied to such a body by an active <connect> or <weld> equality: what a
//                hand holds moves with the hand
//   points       the other vertices on the surface: all in a line or sheet (dim 1, 2), the corners
//                of outer faces in a solid (dim 3)
//   interior     the rest of a solid
#ifndef PHYSPRING_ROLLOUT_FLEX_POINTS_H_
#define PHYSPRING_ROLLOUT_FLEX_POINTS_H_

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "twin/points.h"

namespace physpring {

struct FlexPoints {
  std::vector<int> points, interior, controllers;  // rows of mjData.flexvert_xpos, increasing
  double mass = 0;                                 // kg, of all bodies that carry vertices
};

// Throws Error, beginning with `where`, unless the model has exactly one flex, with free vertices
// that are bodies (dof="full"), at least one vertex held by a mocap body, and none on a jointed
// child of a mocap body (the mocap body would carry it along against all physics).
FlexPoints FindFlexPoints(const mjModel& model, const std::string& where);

// Positions [m] and velocities [m/s] of vertices, one column each; mj_kinematics, mj_comPos and
// mj_flex, for velocities also mj_comVel, must have run.
Points VertexPositions(const mjData& data, const std::vector<int>& vertices);
Points VertexVelocities(const mjModel& model, const mjData& data, const std::vector<int>& vertices);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_FLEX_POINTS_H_
