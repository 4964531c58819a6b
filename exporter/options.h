// SPDX-License-Identifier: Apache-2.0
// How a twin is written as MJCF.
#ifndef PHYSPRING_EXPORTER_OPTIONS_H_
#define PHYSPRING_EXPORTER_OPTIONS_H_

#include <string>

namespace physpring {

// What stands for the springs.
enum class SpringKind {
  kAuto,    // kPlugin if the twin has effects that tendons leave out, else kTendon
  kTendon,  // spatial tendons, one a spring: stock MuJoCo, exact
  kPlugin,  // the plugin physpring.springs: exact, with sub-steps inside one MuJoCo step, fast
  kFlex,    // the edges of a few flexes, springs grouped by stiffness: stock MuJoCo, rounded
};

// What stands for the controllers.
enum class ControllerKind {
  kAuto,   // kSlide if dashpots feel the controllers' velocity and nothing else can supply it
  kMocap,  // mocap bodies: placed by the user, without velocity in MuJoCo
  kSlide,  // bodies on three slide joints that position actuators drive
  kNone,   // nothing: the object is free. The twin must have none: WithoutControllers
};

// What stands for the contact law.
enum class ContactKind {
  kAuto,    // kPlugin with SpringKind::kPlugin, else kMujoco
  kMujoco,  // MuJoCo's soft contacts with the learned friction: stock MuJoCo, an approximation
  kPlugin,  // the plugin: the learned impulse law
  kNone,    // the nodes touch nothing
};

struct ExportOptions {
  std::string name;  // prefix of all names; empty: the twin's name, odd characters become '_'
  int level = -1;    // -1: all
  SpringKind springs = SpringKind::kAuto;
  ControllerKind controllers = ControllerKind::kAuto;
  ContactKind contact = ContactKind::kAuto;
  int flexes = 8;       // at most, for SpringKind::kFlex
  double timestep = 0;  // s, of scene.xml; 0: the level's sub-step, with SpringKind::kPlugin 2 ms
  std::string mesh;     // file of a visual mesh; empty: a surface is made from the points
};

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_OPTIONS_H_
