// SPDX-License-Identifier: Apache-2.0
// What of a scene's soft body is measured, unseen or held. The body is a flex, or bodies that are
// joined by spatial tendons from site to site. Elements are a flex's vertices, or those sites:
//
//   controllers  elements whose body is, or hangs rigidly on, a mocap body or the world, and
//                elements tied to such a body by an active <connect> or <weld> equality: what a
//                hand holds moves with the hand
//   points       the other elements on the surface: all sites, all vertices of a line or sheet
//                (dim 1, 2), the corners of outer faces in a solid (dim 3)
//   interior     the rest of a solid
#ifndef PHYSPRING_ROLLOUT_SOFT_POINTS_H_
#define PHYSPRING_ROLLOUT_SOFT_POINTS_H_

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "twin/points.h"

namespace physpring {

struct SoftPoints {
  bool of_flex = true;                             // else sites
  std::vector<int> points, interior, controllers;  // numbers of vertices or sites, increasing
  double mass = 0;                                 // kg, of all bodies that carry elements

  std::vector<int> Particles() const;  // points, then interior
};

// Tendons of which names begin so are no part of the body: what undeclared_effects.h adds.
inline constexpr char kAddedPrefix[] = "undeclared ";

// Throws Error, beginning with `where`, unless the model has exactly one flex, with free vertices
// that are bodies (dof="full"), or none but spatial tendons from site to site; and at least one
// element held by a mocap body, and none on a jointed child of a mocap body (the mocap body would
// carry it along against all physics).
SoftPoints FindSoftPoints(const mjModel& model, const std::string& where);

// The body that carries an element.
int BodyOf(const mjModel& model, const SoftPoints& soft, int element);

// Positions [m] and velocities [m/s] of elements, one column each; mj_kinematics, mj_comPos and
// mj_flex, for velocities also mj_comVel, must have run.
Points PositionsOf(const mjData& data, const SoftPoints& soft, const std::vector<int>& elements);
Points VelocitiesOf(const mjModel& model, const mjData& data, const SoftPoints& soft,
                    const std::vector<int>& elements);

// The geoms that the body can collide with, without its own.
std::vector<int> GeomsInTheWay(const mjModel& model, const SoftPoints& soft);

// Whether it is a plane fixed in the world.
bool IsGround(const mjModel& model, int geom);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_SOFT_POINTS_H_
