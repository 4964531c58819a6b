// SPDX-License-Identifier: Apache-2.0
// Small MuJoCo models of a spring-mass system, with native tendons or with the plugins.
#ifndef PHYSPRING_TESTS_SUPPORT_LEVEL_SCENE_H_
#define PHYSPRING_TESTS_SUPPORT_LEVEL_SCENE_H_

#include <string>
#include <vector>

#include "rollout/scene.h"
#include "twin/spring_mass_system.h"

namespace physpring {

struct LevelSceneOptions {
  std::string name = "rope";
  bool plugin_springs = true;  // physpring.springs, else native tendons
  bool contact = false;        // the contact law, in the springs' instance or one of its own
  double timestep = 0.5e-3;    // s, of MuJoCo
  double substep = 0.5e-3;     // s, of the drag and of physpring.springs
  bool controller_velocity = true;
  Eigen::Vector3d gravity{0, 0, -9.81};
  std::string parent_pose = "";  // attributes of the parent body
  std::string world = "";        // elements added to the world
  std::string option = "";       // attributes added to <option>
  std::string flags = "";        // attributes of <flag>
  std::vector<std::pair<std::string, std::string>> config =
      {};  // attributes of the instance, instead
};

// MJCF of one level. With `contact`, nodes are spheres of the contact radius, left to the plugin.
std::string LevelMjcf(const SpringMassSystem& system, const LevelSceneOptions& options);

// Loads the plugin library once.
void LoadPlugin();

// Compiles MJCF text. Throws Error with MuJoCo's message; adds warnings to `warnings` or, without
// it, throws Error at the first one.
ModelPtr CompileMjcf(const std::string& mjcf, std::vector<std::string>* warnings = nullptr);

// A simulation of a level that is the only thing with dofs in its world.
class LevelScene {
 public:
  LevelScene(const SpringMassSystem& system, const LevelSceneOptions& options);

  void SetState(const Points& position, const Points& velocity);  // 3 x nodes, m, m/s
  void SetControllers(const Points& position);                    // 3 x controllers, m
  void Step(int count = 1);                                       // throws Error at a warning

  Points Positions() const;   // of the nodes, in the world, 3 x nodes, m
  Points Velocities() const;  // qvel, in the parent's axes, 3 x nodes, m/s
  const mjModel& model() const { return *model_; }
  mjData* data() const { return data_.get(); }

 private:
  int nodes_;
  Points reference_;
  ModelPtr model_;
  DataPtr data_;
};

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_LEVEL_SCENE_H_
