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

// MuJoCo's contacts of so little damping bounce more than once where the learned law bounces once.
constexpr double kMostRestitution = 0.85;

bool BouncesOtherwise(const LevelPlan& plan) {
  return plan.contact == ContactKind::kMujoco &&
         plan.system().contact.surface.restitution > kMostRestitution;
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
  if (BouncesOtherwise(result.levels[0].plan)) {
    result.warnings.push_back(fmt::format(
        "it bounces (restitution {:.2f}), and MuJoCo's contacts follow that badly: with the "
        "plugin's (--contact plugin or --springs plugin) it touches as it was trained",
        result.levels[0].plan.system().contact.surface.restitution));
  }
  result.files["README.md"] = FormatReadme(result.levels, command);
  return result;
}

}  // namespace physpring
