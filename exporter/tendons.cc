// SPDX-License-Identifier: Apache-2.0
#include "exporter/tendons.h"

namespace physpring {

void AddTendons(const LevelPlan& plan, const std::vector<int>& springs, XmlElement* mujoco) {
  if (springs.empty()) return;
  const SpringMassSystem& system = plan.system();
  XmlElement* tendon = AddElement(mujoco, "tendon");
  for (const int e : springs) {
    XmlElement* spatial = AddElement(tendon, "spatial",
                                     {{"class", plan.name},
                                      {"springlength", Number(system.rest_length[e])},
                                      {"stiffness", Number(system.stiffness[e])},
                                      {"damping", Number(system.dashpot[e])}});
    for (const int end : system.springs[e]) {
      AddElement(spatial, "site", {{"site", plan.Body(end)}});
    }
  }
}

}  // namespace physpring
