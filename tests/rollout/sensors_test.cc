// SPDX-License-Identifier: Apache-2.0
// Sensors that a task names are part of what is observed: here the force with which the block acts
// on the hand that pushes it.
#include <gtest/gtest.h>

#include "rollout/plugin_library.h"
#include "rollout/stepped_episode.h"
#include "tests/support/small_task.h"
#include "twin/atomic_file.h"
#include "twin/error.h"
#include "twin/npz.h"

namespace physpring {
namespace {

class SensorsTest : public ::testing::Test {
 protected:
  SensorsTest() {
    LoadPluginLibrary(PHYSPRING_PLUGIN);
    std::string scene = ReadFile(task_.File("scene.xml"));
    scene.replace(scene.find("</mujoco>"), 9, R"(
        <extension><plugin plugin="physpring.force"/></extension>
        <sensor><plugin name="push" plugin="physpring.force" objtype="site" objname="hand"/></sensor>
        </mujoco>)");
    WriteFileAtomically(task_.File("scene.xml"), scene);
    task_.Change(R"("settle": 5)", R"("settle": 5, "sensors": ["push"])");
  }

  SmallTask task_;
};

TEST_F(SensorsTest, TheHandFeelsTheBlockThatItPushes) {
  const Task task = ReadTask(task_.path());
  std::vector<std::string> warnings;
  const TaskModel model = MakeTaskModel(task, 0, &warnings);
  Simulation simulation(model);
  EpisodeResult result;
  result.episode.start = StartOf(task, 1, 0, {});
  SteppedEpisode episode(model, &simulation, &result);
  episode.Begin();
  ASSERT_EQ(episode.observation().sensors.at("push").size(), 6);
  EXPECT_TRUE(episode.observation().sensors.at("push").isZero(0));  // nothing touches it yet
  const NpzArray actions = ReadNpz(task_.WriteActions(0.1, 15)).at("actions");
  const std::vector<double> numbers = actions.ToDoubles();
  double along = 0;
  while (!episode.over()) {
    const int frame = std::min(episode.frame(), 14);
    episode.Step(Eigen::Map<const Eigen::VectorXd>(numbers.data() + 8 * frame, 8));
    along += episode.observation().sensors.at("push")[1];
  }
  // pushed along +y, the block pushes back; the site's axes are the world's
  EXPECT_LT(along, -0.01);
  EXPECT_LT(simulation.Nodes().row(1).minCoeff(), 0.2);
}

TEST_F(SensorsTest, ASensorThatTheSceneLacksIsNamed) {
  task_.Change(R"("sensors": ["push"])", R"("sensors": ["pull"])");
  const Task task = ReadTask(task_.path());
  std::vector<std::string> warnings;
  try {
    MakeTaskModel(task, 0, &warnings);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()),
              task.folder + "/task.json: the scene has no sensor 'pull'");
  }
}

}  // namespace
}  // namespace physpring
