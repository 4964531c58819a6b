// SPDX-License-Identifier: Apache-2.0
#include "exporter/tendons.h"

#include <fmt/format.h>

namespace physpring {

void AddTendons(const LevelPlan& plan, const std::vector<int>& springs, XmlElement* mujoco) {
  if (springs.empty()) return;
  const SpringMassSystem& system = plan.system();
  XmlElement* tendon = Section(mujoco, "tendon");
  for (const int e : springs) {
    XmlElement* spatial = AddElement(tendon, "spatial",
                                     {{"class", plan.name},
                                      {"springlength", Number(system.rest_length[e])},
                                      {"stiffness", Number(system.stiffness[e])},
                                      {"damping", Number(system.dashpot[e])}});
    for (const EffectMjcf& effect : plan.effects) {
      if (effect.tendon.empty()) continue;
      for (const auto& [name, value] : effect.tendon[e]) {
        spatial->SetAttribute(name.c_str(), value.c_str());
      }
    }
    for (const int end : system.springs[e]) {
      AddElement(spatial, "site", {{"site", plan.Body(end)}});
    }
  }
}

void AddAnchors(const LevelPlan& plan, XmlElement* mujoco) {
  int count = 0;
  for (const EffectMjcf& effect : plan.effects) {
    for (const EffectMjcf::Anchor& anchor : effect.anchors) {
      const std::string name = fmt::format("{}_anchor_{}", plan.name, count++);
      AddElement(Section(mujoco, "worldbody"), "site",
                 {{"name", name}, {"class", plan.name}, {"pos", Numbers(anchor.place)}});
      XmlElement* spatial = AddElement(Section(mujoco, "tendon"), "spatial",
                                       {{"class", plan.name},
                                        {"springlength", "0"},
                                        {"stiffness", Number(anchor.stiffness)},
                                        {"damping", Number(anchor.damping)}});
      AddElement(spatial, "site", {{"site", plan.Body(anchor.node)}});
      AddElement(spatial, "site", {{"site", name}});
    }
  }
}

}  // namespace physpring
