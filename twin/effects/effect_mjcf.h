// SPDX-License-Identifier: Apache-2.0
// What stands for an effect in MJCF, as names and values; only the exporter writes XML.
#ifndef PHYSPRING_TWIN_EFFECTS_EFFECT_MJCF_H_
#define PHYSPRING_TWIN_EFFECTS_EFFECT_MJCF_H_

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

namespace physpring {

struct EffectMjcf {
  // How MuJoCo's own features carry the effect.
  enum class Carrier {
    kSetting,  // by the masses, rest lengths, gravity and contacts that it changed
    kTendon,   // by attributes of the springs' tendons
    kAnchor,   // by extra tendons to sites of the world
    kPlugin,   // not at all: only the plugin does
  };
  // A spring from a node to a point of the world, of rest length 0.
  struct Anchor {
    int node;
    Eigen::Vector3d place;  // m
    double stiffness;       // N/m
    double damping;         // N s/m
  };
  Carrier carrier = Carrier::kPlugin;
  std::vector<std::map<std::string, std::string>> tendon;  // attributes of each spring's tendon
  std::vector<Anchor> anchors;
  std::string difference;  // in words: where MuJoCo's own feature differs; empty if it does not
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_EFFECTS_EFFECT_MJCF_H_
