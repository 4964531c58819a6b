// SPDX-License-Identifier: Apache-2.0
// Plugin instances as MuJoCo handles them: state, copies, several in one model, batches.
#include <gtest/gtest.h>
#include <mujoco/mjbatch.h>

#include <fstream>

#include "tests/support/level_scene.h"
#include "tests/support/random_system.h"
#include "tests/support/temporary_folder.h"

namespace physpring {
namespace {

const LevelSceneOptions kSubsteps{.timestep = 2e-3, .substep = 0.25e-3};

LevelScene ShakenScene(const LevelSceneOptions& options = kSubsteps) {
  const SpringMassSystem system = RandomSystem(40, 2, 3);
  LevelScene scene(system, options);
  Random random(1);
  scene.SetState(system.position.leftCols(40), random.Box(40, 0.5));
  scene.Step(10);
  return scene;
}

std::vector<double> State(const mjModel& model, const mjData* data) {
  std::vector<double> state(static_cast<std::size_t>(mj_stateSize(&model, mjSTATE_INTEGRATION)));
  mj_getState(&model, data, state.data(), mjSTATE_INTEGRATION);
  return state;
}

TEST(Instance, SetStateRestoresTheMotion) {
  LevelScene scene = ShakenScene();
  const std::vector<double> state = State(scene.model(), scene.data());
  scene.Step(10);
  const Points positions = scene.Positions();
  mj_setState(&scene.model(), scene.data(), state.data(), mjSTATE_INTEGRATION);
  scene.Step(10);
  EXPECT_EQ(scene.Positions(), positions);
}

TEST(Instance, ResetForgetsTheMotion) {
  LevelScene scene = ShakenScene();
  mj_resetData(&scene.model(), scene.data());
  scene.Step(10);
  const LevelScene fresh(RandomSystem(40, 2, 3), kSubsteps);
  for (int i = 0; i < 10; ++i) mj_step(&fresh.model(), fresh.data());
  EXPECT_EQ(scene.Positions(), fresh.Positions());
}

TEST(Instance, CopyGoesOnAlike) {
  LevelScene scene = ShakenScene();
  const DataPtr made(mj_copyData(nullptr, &scene.model(), scene.data()));
  const DataPtr copied = MakeData(scene.model());
  mj_copyData(copied.get(), &scene.model(), scene.data());
  scene.Step(10);
  for (mjData* copy : {made.get(), copied.get()}) {
    for (int i = 0; i < 10; ++i) mj_step(&scene.model(), copy);
    EXPECT_EQ(State(scene.model(), copy), State(scene.model(), scene.data()));
  }
}

TEST(Instance, ForwardChangesNothing) {
  LevelScene scene = ShakenScene(), other = ShakenScene();
  for (int i = 0; i < 5; ++i) {
    mj_forward(&scene.model(), scene.data());
    mj_forward(&scene.model(), scene.data());
    scene.Step();
    other.Step();
  }
  EXPECT_EQ(scene.Positions(), other.Positions());
}

TEST(Instance, PushesFromOutsideAreCarriedOver) {
  SpringMassSystem system = RandomSystem(40, 0, 3);
  system.drag = 0;
  LevelScene scene(system, {.timestep = 2e-3, .substep = 0.25e-3, .gravity = {0, 0, 0}});
  scene.data()->qfrc_applied[2] = 1;  // N, on the first node for one step
  scene.Step();
  scene.data()->qfrc_applied[2] = 0;
  scene.Step(100);
  EXPECT_NEAR(scene.Velocities().row(2).dot(system.mass), 2e-3, 1e-4);
}

// The same level twice in one model, attached with prefixes.
TEST(Instance, AttachesTwiceWithPrefixes) {
  LoadPlugin();
  const SpringMassSystem system = RandomSystem(40, 2, 3);
  const TemporaryFolder folder;
  std::ofstream(folder.File("rope.xml")) << LevelMjcf(system, kSubsteps);
  std::ofstream(folder.File("scene.xml")) << R"(
    <mujoco>
      <option timestep="0.002"/>
      <asset><model name="rope" file="rope.xml"/></asset>
      <worldbody>
        <frame pos="-1 0 0" euler="0 0 90"><attach model="rope" prefix="left/"/></frame>
        <attach model="rope" prefix="right/"/>
      </worldbody>
    </mujoco>)";
  std::vector<std::string> warnings;
  const ModelPtr model = LoadScene(folder.File("scene.xml"), &warnings);
  EXPECT_TRUE(warnings.empty());
  ASSERT_EQ(model->nplugin, 2);
  const DataPtr data = MakeData(*model);
  LevelScene alone(system, kSubsteps);
  for (int i = 0; i < 20; ++i) Step(*model, data.get());
  alone.Step(20);
  for (int copy : {0, 1}) {
    const Eigen::Map<const Points> moved(data->qpos + 120 * copy, 3, 40);
    EXPECT_LT((system.position.leftCols(40) + moved - alone.Positions()).norm(), 1e-12);
  }
}

TEST(Instance, SurvivesSaveAndReload) {
  LevelScene scene = ShakenScene();
  std::vector<char> buffer(static_cast<std::size_t>(mj_sizeModel(&scene.model())));
  mj_saveModel(&scene.model(), nullptr, buffer.data(), static_cast<mjtSize>(buffer.size()));
  const ModelPtr loaded(mj_loadModelBuffer(buffer.data(), static_cast<mjtSize>(buffer.size())));
  ASSERT_NE(loaded, nullptr);
  const DataPtr data = MakeData(*loaded);
  const std::vector<double> state = State(scene.model(), scene.data());
  mj_setState(loaded.get(), data.get(), state.data(), mjSTATE_INTEGRATION);
  for (int i = 0; i < 10; ++i) Step(*loaded, data.get());
  scene.Step(10);
  EXPECT_EQ(State(*loaded, data.get()), State(scene.model(), scene.data()));
}

// Simulations of one model that differ in their start, on two threads.
TEST(Instance, BatchGivesTheBitsOfALoop) {
  constexpr int kSimulations = 4;
  LevelScene scene = ShakenScene();
  const mjModel& model = scene.model();
  mjBatchConfig config;
  mjb_defaultConfig(&config);
  config.nthread = 2;
  char error[1000] = "";
  mjBatch* batch = mjb_makeBatch(&model, kSimulations, &config, error, sizeof(error));
  ASSERT_NE(batch, nullptr) << error;
  const std::vector<double> start = State(model, scene.data());
  const int size = mjb_nstate(batch);
  ASSERT_EQ(size, static_cast<int>(start.size()));
  for (int i = 0; i < kSimulations; ++i) {
    double* row = mjb_state(batch) + i * size;
    std::copy(start.begin(), start.end(), row);
    row[1] += 1e-3 * i;  // after the time: the first node's qpos
  }
  EXPECT_EQ(mjb_step(batch, nullptr, 0, 20, mjSTAGE_NONE), 0);
  for (int i = 0; i < kSimulations; ++i) {
    mj_setState(&model, scene.data(), start.data(), mjSTATE_INTEGRATION);
    scene.data()->qpos[0] += 1e-3 * i;
    scene.Step(20);
    const double* row = mjb_state(batch) + i * size;
    EXPECT_EQ(std::vector<double>(row, row + size), State(model, scene.data())) << i;
  }
  mjb_deleteBatch(batch);
}

TEST(Instance, WithoutPassiveForcesNodesFallFreely) {
  LevelScene scene(
      RandomSystem(40, 2, 3),
      {.timestep = 2e-3, .substep = 0.25e-3, .flags = R"(spring="disable" damper="disable")"});
  scene.Step(10);
  EXPECT_NEAR(scene.Velocities().col(0)[2], -9.81 * 0.02, 1e-12);
}

}  // namespace
}  // namespace physpring
