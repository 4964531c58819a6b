// SPDX-License-Identifier: Apache-2.0
// Which MuJoCo an exported model needs; older_mujoco_test.py loads one in older ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/exported_folder.h"
#include "tests/support/small_twin.h"
#include "twin/atomic_file.h"
#include "twin/effects/registry.h"

namespace physpring {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string Readme(const Twin& twin, SpringKind springs) {
  ExportOptions options;
  options.springs = springs;
  return ExportTwin(twin, options, "physpring export").files.at("README.md");
}

// The compiled model as MuJoCo keeps it in a file.
std::string Compiled(const ExportedFolder& folder, const std::string& scene) {
  const ModelPtr model = folder.Load(scene);
  mj_saveModel(model.get(), folder.File("model.mjb").c_str(), nullptr, 0);
  return ReadFile(folder.File("model.mjb"));
}

// MuJoCo before 4.0 does not know that attribute of tendons' defaults.
TEST(NeededMujoco, DefaultsOfTendonsLeaveOutTheArmatureThatIsZeroAnyway) {
  const ExportedFolder folder(SmallTwin(1), {});
  const std::string plain = Compiled(folder, "scene.xml");
  std::string level = ReadFile(folder.File("level0.xml"));
  const std::size_t tendon = level.find("<tendon width");
  ASSERT_NE(tendon, std::string::npos);
  const std::string defaults = level.substr(tendon, level.find("/>", tendon) - tendon);
  EXPECT_THAT(defaults, Not(HasSubstr("armature")));
  level.insert(tendon + std::string("<tendon").size(), " armature=\"0\"");
  std::ofstream(folder.File("level0.xml")) << level;
  EXPECT_EQ(Compiled(folder, "scene.xml"), plain);
}

TEST(NeededMujoco, IsInTheReadme) {
  Twin twin = SmallTwin(1);
  EXPECT_THAT(Readme(twin, SpringKind::kTendon), HasSubstr("Requires MuJoCo 3.6 or later.\n"));
  EXPECT_THAT(Readme(twin, SpringKind::kPlugin),
              HasSubstr("Requires MuJoCo 4.0 and PhySPRING's plugin library. MJX ignores"));
  twin.levels[0].system.effects.push_back({"stiffening", Eigen::VectorXd::Constant(1, 3)});
  EXPECT_THAT(Readme(twin, SpringKind::kTendon), HasSubstr("Requires MuJoCo 4.0 or later.\n"));
}

}  // namespace
}  // namespace physpring
