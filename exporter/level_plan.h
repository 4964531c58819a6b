// SPDX-License-Identifier: Apache-2.0
// What is decided about a level before any XML is written: names, kinds and time steps.
#ifndef PHYSPRING_EXPORTER_LEVEL_PLAN_H_
#define PHYSPRING_EXPORTER_LEVEL_PLAN_H_

#include <algorithm>
#include <string>
#include <vector>

#include "exporter/options.h"
#include "twin/effects/effect.h"
#include "twin/twin.h"

namespace physpring {

// Refers to the twin that it was made of.
struct LevelPlan {
  const Twin* twin = nullptr;
  int level = 0;
  std::string name;  // prefix of all names
  SpringKind springs = SpringKind::kTendon;
  ControllerKind controllers = ControllerKind::kMocap;  // never kAuto
  ContactKind contact = ContactKind::kMujoco;           // never kAuto
  int flexes = 0;                                       // at most
  double substep = 0;                                   // s: of the springs and the drag
  double timestep = 0;           // s: of scene.xml; equal to the sub-step without the plugin
  double critical_timestep = 0;  // s: the largest stable sub-step
  double largest_timestep = 0;   // s: steps of MuJoCo below it are stable; infinity: any

  // The level as its effects change it, and what carries those effects in MuJoCo.
  Setting setting;
  std::vector<EffectMjcf> effects;           // by MuJoCo's own features
  std::vector<EffectValues> plugin_effects;  // by the plugin
  std::vector<std::string> differences;      // from the trained level, in words

  const SpringMassSystem& system() const { return setting.system; }
  bool NeedsPlugin() const {
    return springs == SpringKind::kPlugin || contact == ContactKind::kPlugin;
  }
  // Whether the scene must ask for another cone of friction than MuJoCo's default.
  bool WantsEllipticCone() const {
    return contact == ContactKind::kMujoco &&
           system().contact.surface.cone == FrictionCone::kElliptic;
  }
  // s: the least of both bounds.
  double StableTimestep() const { return std::min(critical_timestep, largest_timestep); }
  // "0.2 ms", or "any".
  std::string LargestTimestep() const;
  // Name of the body and of the site of node or controller `column`.
  std::string Body(int column) const;
  // Name of the body on a node that is a flex's vertex: MuJoCo lets no body with joint damping be
  // one.
  std::string Vertex(int node) const;
  std::string NodeClass() const { return name + "_node"; }
  std::string ControllerClass() const { return name + "_controller"; }
};

// The sub-step is the one that the trainer and `physpring eval` use: 0.7 of the stability bound's
// (kStepSafety), never longer than in training, and a frame is a whole number of them; or, without
// the plugin, options.timestep. Throws Error if the level does not exist, if that time step is not
// stable, or if the name has characters other than letters, digits and "_.-".
LevelPlan PlanLevel(const Twin& twin, int level, const ExportOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_LEVEL_PLAN_H_
