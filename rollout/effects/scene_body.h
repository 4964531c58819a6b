// SPDX-License-Identifier: Apache-2.0
// The soft body of a scene that gets effects, as the scene is without them, in its reference
// configuration (qpos0, mocap bodies where the file puts them).
#ifndef PHYSPRING_ROLLOUT_EFFECTS_SCENE_BODY_H_
#define PHYSPRING_ROLLOUT_EFFECTS_SCENE_BODY_H_

#include <mujoco/mujoco.h>

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "rollout/soft_points.h"

namespace physpring {

class SceneBody {
 public:
  // Both must outlive this.
  SceneBody(const mjModel& plain, const SoftPoints& soft);

  const mjModel& plain() const { return plain_; }
  bool of_flex() const { return soft_.of_flex; }          // else of tendons
  const Points& reference() const { return reference_; }  // particles, 3 x ., m
  const Points& held() const { return held_; }            // controllers, 3 x ., m
  const Points& vertices() const { return vertices_; }    // all of flexes, 3 x ., m

  // The body that carries a particle, and all such bodies.
  int CarrierOf(int particle) const;
  const std::set<int>& Carriers() const { return carriers_; }

  // The grounds that the body can collide with: geoms.
  std::vector<int> Grounds() const;

  // The particle that is farthest from all controllers, and the one next to a place.
  int FreeEnd() const;
  int NearestTo(const Eigen::Vector3d& place) const;

  // Calls edit(tendon, its number) for each tendon of a body of tendons from site to site.
  void ForEachTendon(mjSpec* spec, const std::function<void(mjsTendon*, int)>& edit) const;
  // The middle between the two sites of a tendon, m.
  Eigen::Vector3d MiddleOf(int tendon) const;
  // Calls edit(tendon) for each elastic edge of a body that is a flex: a tendon along it, added
  // where there is none yet, without stiffness and as long at rest as the edge is.
  void ForEachEdgeTendon(mjSpec* spec, const std::function<void(mjsTendon*)>& edit) const;

  // The name of a site on a particle.
  std::string SiteOn(int particle, mjSpec* spec) const;

 private:
  std::string SiteOfElement(int element, mjSpec* spec) const;

  const mjModel& plain_;
  const SoftPoints& soft_;
  std::vector<int> particles_;  // elements, points before interior
  std::set<int> carriers_;
  Points reference_, held_, vertices_, sites_;
};

// Adds a tendon without thickness from site to site; `name` follows kAddedPrefix.
mjsTendon* AddTendon(mjSpec* spec, const std::string& name, const std::string& from,
                     const std::string& to);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_EFFECTS_SCENE_BODY_H_
