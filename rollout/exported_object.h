// SPDX-License-Identifier: Apache-2.0
// A level of a twin that `physpring export` wrote, found in a compiled scene by its names: nodes
// NAME_i on three slide joints, controllers NAME_controller_c, mocap bodies or driven ones.
#ifndef PHYSPRING_ROLLOUT_EXPORTED_OBJECT_H_
#define PHYSPRING_ROLLOUT_EXPORTED_OBJECT_H_

#include <mujoco/mujoco.h>

#include <optional>
#include <string>
#include <vector>

#include "twin/grasp_springs.h"
#include "twin/plugin_state.h"
#include "twin/points.h"

namespace physpring {

class ExportedObject {
 public:
  // The model lives longer. Throws Error, beginning with `where`, unless there is exactly one.
  ExportedObject(const mjModel& model, const std::string& where);

  int node_count() const { return static_cast<int>(nodes_.size()); }
  int controller_count() const { return static_cast<int>(controllers_.size()); }

  // All positions [m] and velocities [m/s] are the world's, one column for each node or controller,
  // and mj_kinematics must have run.
  void SetNodes(const Points& position, const Points& velocity, mjData* data) const;
  Points Nodes(const mjData& data) const;

  // Mocap bodies have no velocity.
  void SetControllers(const Points& position, const Points& velocity, mjData* data) const;
  // The next step begins with the mocap controllers there; else they stand still in the first one.
  void StartControllers(const Points& position, mjData* data) const;
  // Some controllers let go, the others hold; those of `taken` take hold. Throws Error if the
  // springs are not the plugin's: those of MuJoCo hold for good.
  void SetGrasps(const ControllerMask& released, const Attachment& taken, mjData* data) const;

 private:
  // By slide joints, qpos and qvel.
  void PlaceBody(const Eigen::Vector3d& position, const Eigen::Vector3d& velocity, int body,
                 mjData* data) const;

  // A spring that joins a controller to a node.
  struct GraspSpring {
    int node, controller;
    double reference;  // its length at qpos0, m
  };

  // None if the springs are not the plugin's.
  std::optional<PluginState> StateOf(mjData* data) const;
  std::vector<GraspSpring> GraspSprings() const;

  const mjModel& model_;
  int instance_ = -1;                       // of the plugin; -1: none
  std::vector<GraspSpring> grasp_springs_;  // of the plugin's
  std::vector<int> nodes_, controllers_;    // bodies
  std::vector<int> actuators_;              // the first of three for each driven controller
};

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_EXPORTED_OBJECT_H_
