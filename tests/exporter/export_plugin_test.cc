// SPDX-License-Identifier: Apache-2.0
// Exported levels with the engine plugin: they compile and run without a warning, alone and
// attached twice, and move as in the trainer.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "rollout/mujoco_log.h"
#include "tests/support/exported_folder.h"
#include "tests/support/random_system.h"
#include "tests/support/small_twin.h"
#include "twin/atomic_file.h"
#include "twin/effects/registry.h"
#include "twin/free_twin.h"
#include "twin/simulator.h"

namespace physpring {
namespace {

class ExportPlugin : public testing::Test {
 protected:
  static void SetUpTestSuite() { mj_loadPluginLibrary(PHYSPRING_PLUGIN); }

  static ExportOptions Options(SpringKind springs, double timestep) {
    ExportOptions options;
    options.springs = springs;
    options.contact = ContactKind::kPlugin;
    options.timestep = timestep;
    return options;
  }
};

TEST_F(ExportPlugin, RunsEachSceneWithoutAWarning) {
  Twin twin = SmallTwin(2);
  for (TwinLevel& level : twin.levels) level.system.contact.collision_distance = 0.01;
  for (const SpringKind springs : {SpringKind::kTendon, SpringKind::kPlugin, SpringKind::kFlex}) {
    const ExportedFolder folder(twin, Options(springs, 0));
    for (const ExportedLevel& level : folder.result.levels) {
      const ModelPtr model = folder.Load(level.scene);
      EXPECT_EQ(model->nplugin, 1);
      const DataPtr data = MakeData(*model);
      const int key = mj_name2id(model.get(), mjOBJ_KEY, "test");
      mj_resetDataKeyframe(model.get(), data.get(), key);
      for (int step = 0; step < 1000; ++step) Step(*model, data.get());
      EXPECT_LT(mju_norm(data->qpos, model->nq), 1) << level.scene;
    }
  }
}

TEST_F(ExportPlugin, AttachesTwice) {
  const Twin twin = SmallTwin(1);
  const ExportedFolder folder(twin, Options(SpringKind::kPlugin, 0));
  const ModelPtr model = folder.LoadText(R"(
    <mujoco>
      <asset><model name="twin" file="level0.xml"/></asset>
      <worldbody>
        <frame pos="1 0 0"><attach model="twin" prefix="a_"/></frame>
        <frame pos="-1 0 0" euler="0 0 90"><attach model="twin" prefix="b_"/></frame>
      </worldbody>
    </mujoco>)");
  EXPECT_EQ(model->nplugin, 2);
  const DataPtr data = MakeData(*model);
  for (int step = 0; step < 500; ++step) Step(*model, data.get());
  const int a = mj_name2id(model.get(), mjOBJ_BODY, "a_block_7");
  const int b = mj_name2id(model.get(), mjOBJ_BODY, "b_block_7");
  EXPECT_LT(data->xpos[3 * a + 2], model->body_pos[3 * a + 2] - 1e-3);  // it sags
  EXPECT_NEAR(data->xpos[3 * a + 2], data->xpos[3 * b + 2], 1e-9);
}

// The height of the lowest node of a twin that falls on another one, after 0.4 s, m. Geoms of the
// twins' nodes have the attributes `lower` and `upper`.
double HeightOfFallen(const ExportedFolder& folder, const std::string& lower,
                      const std::string& upper) {
  const std::string level = ReadFile(folder.File("level0.xml")), bits = R"(contype="0")";
  const auto write = [&](const char* name, const std::string& attributes) {
    std::string changed = level;
    std::ofstream(folder.File(name)) << changed.replace(level.find(bits), bits.size(), attributes);
  };
  write("lower.xml", lower);
  write("upper.xml", upper);
  const ModelPtr model = folder.LoadText(R"(
    <mujoco>
      <option timestep="0.0005" integrator="Euler"/>
      <asset><model name="lower" file="lower.xml"/><model name="upper" file="upper.xml"/></asset>
      <worldbody>
        <geom type="plane" size="0 0 1"/>
        <frame pos="0 0 0.013"><attach model="lower" prefix="a_"/></frame>
        <frame pos="0 0 0.07"><attach model="upper" prefix="b_"/></frame>
      </worldbody>
    </mujoco>)");
  const DataPtr data = MakeData(*model);
  for (int step = 0; step < 800; ++step) Step(*model, data.get());
  double lowest = 1;
  for (int i = 0; i < 40; ++i) {
    const int body = mj_name2id(model.get(), mjOBJ_BODY, fmt::format("b_block_{}", i).c_str());
    lowest = std::min(lowest, data->xpos[3 * body + 2]);
  }
  return lowest;
}

// As docs/export.md tells: bits of their own let twins collide with each other, else they do not.
TEST_F(ExportPlugin, TwinsCollideWhereTheirBitsSaySo) {
  const double radius = 0.012;  // m: no gaps between the particles, which are 20 mm apart
  Twin twin = WithoutControllers(SmallTwin(1));
  twin.levels[0].system.contact_radius.setConstant(radius);
  const ExportedFolder folder(twin, Options(SpringKind::kPlugin, 0));
  EXPECT_NEAR(HeightOfFallen(folder, R"(contype="0")", R"(contype="0")"), radius, 2e-3);
  // on the other's upper layer, 32 mm high, but for what the soft springs give way
  EXPECT_GT(HeightOfFallen(folder, R"(contype="2")", R"(contype="0" conaffinity="3")"), 0.03);
}

// The greatest distance of a node from where the trainer has it, after 20 frames of 5 steps with
// 20 sub-steps each in which the controllers move on random ways, m.
double DistanceFromTrainer(const Twin& twin) {
  ExportOptions options;
  options.springs = SpringKind::kPlugin;
  options.contact = ContactKind::kNone;
  const double substep = PlanLevel(twin, 0, options).substep;
  options.timestep = 20 * substep;
  const ExportedFolder folder(twin, options);
  const LevelPlan& plan = folder.result.levels[0].plan;
  const ModelPtr model = folder.Load("scene.xml");
  const DataPtr data = MakeData(*model);

  const SpringMassSystem& trained = twin.levels[0].system;
  Environment environment;
  environment.gravity = twin.gravity;
  const Simulator<double> simulator(trained, environment,
                                    {100 * substep, 100, twin.controller_velocity});
  Simulator<double>::Workspace workspace(simulator);
  Random random(7);
  const int nodes = trained.node_count();
  const Points start = trained.position.leftCols(nodes), velocity = random.Box(nodes, 0.5);
  auto state = simulator.MakeState(start, velocity);
  Eigen::Map<Points>(data->qvel, 3, nodes) = velocity;

  Points hands = trained.position.rightCols(trained.controllers);
  for (int frame = 0; frame < 20; ++frame) {
    // not in the first one: the plugin has yet to see where they are
    const Points next = hands + random.Box(trained.controllers, frame == 0 ? 0 : 0.02);
    simulator.AdvanceFrame({hands, next, {}}, &state, &workspace);
    for (int step = 1; step <= 5; ++step) {
      Eigen::Map<Points>(data->mocap_pos, 3, trained.controllers) =
          hands + (next - hands) * (step / 5.0);
      Step(*model, data.get());
    }
    hands = next;
  }
  const Points moved =
      plan.system().position.leftCols(nodes) + Eigen::Map<const Points>(data->qpos, 3, nodes);
  EXPECT_GT((moved - start).cwiseAbs().maxCoeff(), 0.02);
  return (simulator.Positions(state) - moved).cwiseAbs().maxCoeff();
}

TEST_F(ExportPlugin, MovesAsInTheTrainer) {
  Twin twin = SmallTwin(1);
  for (const bool velocity : {true, false}) {
    twin.controller_velocity = velocity;
    EXPECT_LT(DistanceFromTrainer(twin), 1e-9);
  }
}

TEST_F(ExportPlugin, CarriesForcesOfEffects) {
  Twin twin = SmallTwin(1);
  SpringMassSystem& system = twin.levels[0].system;
  for (const char* name : {"air_drag", "stiffening", "mass_distribution"}) {
    system.effects.push_back({name, GetEffect(name).Starts(system)[0]});
  }
  EXPECT_LT(DistanceFromTrainer(twin), 1e-9);
}

}  // namespace
}  // namespace physpring
