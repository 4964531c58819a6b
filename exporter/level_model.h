// SPDX-License-Identifier: Apache-2.0
// A level of a twin as an MJCF model of its own, for <include> and <attach>: bodies, springs,
// controllers and picture, all names with the twin's prefix, and nothing that would change the
// scene around it (time step, gravity, ... are the scene's).
#ifndef PHYSPRING_EXPORTER_LEVEL_MODEL_H_
#define PHYSPRING_EXPORTER_LEVEL_MODEL_H_

#include <string>

#include "exporter/flexes.h"
#include "exporter/level_plan.h"
#include "exporter/picture.h"

namespace physpring {

// `flexes`: which springs are edges of which flex, for SpringKind::kFlex.
std::string FormatLevel(const LevelPlan& plan, const FlexGroups& flexes, const Picture& picture);

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_LEVEL_MODEL_H_
