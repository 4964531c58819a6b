// SPDX-License-Identifier: Apache-2.0
#include "exporter/export.h"

#include <fmt/format.h>

#include "exporter/level_model.h"
#include "exporter/readme.h"
#include "exporter/scene.h"
#include "twin/ground.h"

namespace physpring {
namespace {

std::vector<int> ChosenLevels(const Twin& twin, const ExportOptions& options) {
  if (options.level >= 0) return {options.level};
  std::vector<int> levels;
  for (std::size_t i = 0; i < twin.levels.size(); ++i) levels.push_back(static_cast<int>(i));
  return levels;
}

}  // namespace

Export ExportTwin(const Twin& twin, const ExportOptions& options, const std::string& command) {
  Export result;
  const Picture picture = MakePicture(twin, options.mesh);
  result.warnings = picture.warnings;
  for (const int number : ChosenLevels(twin, options)) {
    ExportedLevel level;
    level.plan = PlanLevel(twin, number, options);
    if (level.plan.springs == SpringKind::kFlex) {
      level.flexes = GroupSprings(level.plan.system(), level.plan.flexes);
    }
    level.model = fmt::format("level{}.xml", number);
    level.scene = result.levels.empty() ? "scene.xml" : fmt::format("scene_level{}.xml", number);
    result.files[level.model] = FormatLevel(level.plan, level.flexes, picture);
    result.files[level.scene] = FormatScene(level.plan, level.model);
    result.levels.push_back(std::move(level));
  }
  if (!twin.ground.known) {
    result.warnings.push_back(
        fmt::format("the twin does not say what ground it was trained with (a file of an older "
                    "program): the scenes get the floor {}; train it again to know",
                    DescribeGround(GroundOf(result.levels[0].plan))));
  }
  result.files["README.md"] = FormatReadme(result.levels, command);
  return result;
}

}  // namespace physpring
