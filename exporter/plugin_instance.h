// SPDX-License-Identifier: Apache-2.0
// The plugin's part of a level: one explicit instance, named like the twin, of physpring.springs
// (springs, drag and contact) or of physpring.contact (contact alone). plugin/README.md describes
// the keys.
#ifndef PHYSPRING_EXPORTER_PLUGIN_INSTANCE_H_
#define PHYSPRING_EXPORTER_PLUGIN_INSTANCE_H_

#include "exporter/level_plan.h"
#include "exporter/xml.h"

namespace physpring {

// Nothing for a level that needs no plugin.
void AddPluginInstance(const LevelPlan& plan, XmlElement* mujoco);

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_PLUGIN_INSTANCE_H_
