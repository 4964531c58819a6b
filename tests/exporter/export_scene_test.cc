// SPDX-License-Identifier: Apache-2.0
// What `physpring export` writes, as a MuJoCo user meets it: it compiles and runs without a
// warning, in its own scene and in others.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <tuple>

#include "rollout/mujoco_log.h"
#include "rollout/scene_ground.h"
#include "tests/support/exported_folder.h"
#include "tests/support/small_twin.h"
#include "twin/atomic_file.h"
#include "twin/effects/registry.h"
#include "twin/error.h"

namespace physpring {
namespace {

int Id(const ModelPtr& model, mjtObj type, const std::string& name) {
  return mj_name2id(model.get(), type, name.c_str());
}

ExportOptions Options(SpringKind springs, ControllerKind controllers, ContactKind contact) {
  ExportOptions options;
  options.springs = springs;
  options.controllers = controllers;
  options.contact = contact;
  return options;
}

class StockMujoco
    : public testing::TestWithParam<std::tuple<SpringKind, ControllerKind, ContactKind>> {
 protected:
  ExportOptions options() const { return std::apply(Options, GetParam()); }
};

TEST_P(StockMujoco, RunsEachSceneWithoutAWarning) {
  const Twin twin = SmallTwin(3);
  const ExportedFolder folder(twin, options());
  for (const ExportedLevel& level : folder.result.levels) {
    const ModelPtr model = folder.Load(level.scene);
    const DataPtr data = MakeData(*model);
    mj_resetDataKeyframe(model.get(), data.get(), Id(model, mjOBJ_KEY, "test"));
    EXPECT_EQ(data->qvel[0], 0.5);
    for (int step = 0; step < 1000; ++step) Step(*model, data.get());
    EXPECT_LT(mju_norm(data->qpos, model->nq), 1) << level.model;
  }
}

TEST_P(StockMujoco, SavesAndReloads) {
  const Twin twin = SmallTwin(1);
  const ExportedFolder folder(twin, options());
  const ModelPtr model = folder.Load("scene.xml");
  char message[500] = "";
  ASSERT_TRUE(mj_saveLastXML(folder.File("saved.xml").c_str(), model.get(), message, 500))
      << message;
  mj_saveModel(model.get(), folder.File("saved.mjb").c_str(), nullptr, 0);
  const ModelPtr from_xml = folder.Load("saved.xml");
  const ModelPtr from_mjb(mj_loadModel(folder.File("saved.mjb").c_str(), nullptr));
  ASSERT_TRUE(from_mjb);
  const DataPtr data = MakeData(*model), xml_data = MakeData(*from_xml),
                mjb_data = MakeData(*from_mjb);
  for (int step = 0; step < 100; ++step) {
    Step(*model, data.get());
    Step(*from_xml, xml_data.get());
    Step(*from_mjb, mjb_data.get());
  }
  for (int i = 0; i < model->nq; ++i) {
    EXPECT_NEAR(xml_data->qpos[i], data->qpos[i], 1e-6);  // MuJoCo saves 6 digits of a number
    EXPECT_EQ(mjb_data->qpos[i], data->qpos[i]);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, StockMujoco,
    testing::Combine(testing::Values(SpringKind::kTendon, SpringKind::kFlex),
                     testing::Values(ControllerKind::kMocap, ControllerKind::kSlide),
                     testing::Values(ContactKind::kMujoco, ContactKind::kNone)));

constexpr char kAttachedTwice[] = R"(
  <mujoco>
    <option timestep="0.0005"/>
    <asset><model name="twin" file="level0.xml"/></asset>
    <worldbody>
      <body pos="0 0 1"><freejoint/><geom size="0.1"/></body>
      <frame pos="1 0 0"><attach model="twin" prefix="a_"/></frame>
      <frame pos="-1 0 0" euler="0 0 90"><attach model="twin" prefix="b_"/></frame>
    </worldbody>
    <keyframe><key name="home"/></keyframe>
  </mujoco>)";

TEST(ExportScene, AttachesTwice) {
  const Twin twin = SmallTwin(1);
  for (const ControllerKind controllers : {ControllerKind::kMocap, ControllerKind::kSlide}) {
    const ExportedFolder folder(twin,
                                Options(SpringKind::kTendon, controllers, ContactKind::kMujoco));
    const ModelPtr model = folder.LoadText(kAttachedTwice);
    EXPECT_EQ(model->ntendon, 2 * twin.levels[0].system.spring_count());
    EXPECT_GE(Id(model, mjOBJ_BODY, "a_block_39"), 0);
    EXPECT_GE(Id(model, mjOBJ_SITE, "b_block_controller_1"), 0);
    EXPECT_GE(Id(model, mjOBJ_KEY, "b_block_home"), 0);
    const DataPtr data = MakeData(*model);
    for (int step = 0; step < 1000; ++step) Step(*model, data.get());
    const mjtNum* a = data->xpos + 3 * Id(model, mjOBJ_BODY, "a_block_7");
    const mjtNum* b = data->xpos + 3 * Id(model, mjOBJ_BODY, "b_block_7");
    EXPECT_NEAR(a[2], b[2], 1e-9);
  }
}

TEST(ExportScene, IsIncludedAmongOthers) {
  const Twin twin = SmallTwin(1);
  const ExportedFolder folder(twin, {});
  const ModelPtr model = folder.LoadText(R"(
    <mujoco>
      <option timestep="0.0005" gravity="0 0 -1.62" integrator="implicitfast"/>
      <worldbody><body name="box" pos="0 0 1"><freejoint/><geom size="0.1"/></body></worldbody>
      <include file="level0.xml"/>
      <keyframe><key name="home"/></keyframe>
    </mujoco>)");
  // what the host scene says still holds
  EXPECT_EQ(model->opt.timestep, 0.0005);
  EXPECT_EQ(model->opt.gravity[2], -1.62);
  EXPECT_EQ(model->opt.integrator, mjINT_IMPLICITFAST);
  EXPECT_EQ(model->geom_group[0], 0);
  EXPECT_GE(Id(model, mjOBJ_KEY, "block_home"), 0);
}

TEST(ExportScene, HoldsWhatTheTwinHolds) {
  Twin twin = SmallTwin(1);
  SpringMassSystem& system = twin.levels[0].system;
  system.stiffness[3] = 100.0 / 3;
  system.dashpot[3] = 1.0 / 30;
  system.rest_length[3] = 0.1 / 7;
  system.mass[2] = 0.01 / 3;
  system.position(0, 2) += 0.001 / 3;
  const ExportedFolder folder(twin, {});
  const ModelPtr model = folder.Load("scene.xml");
  // to the last bit
  EXPECT_EQ(model->tendon_stiffness[3], system.stiffness[3]);
  EXPECT_EQ(model->tendon_damping[3], system.dashpot[3]);
  EXPECT_EQ(model->tendon_lengthspring[2 * 3], system.rest_length[3]);
  EXPECT_EQ(model->tendon_lengthspring[2 * 3 + 1], system.rest_length[3]);
  const int body = Id(model, mjOBJ_BODY, "block_2");
  EXPECT_EQ(model->body_mass[body], system.mass[2]);
  EXPECT_EQ(model->body_pos[3 * body], system.position(0, 2));
  const int numeric = Id(model, mjOBJ_NUMERIC, "block_critical_timestep");
  EXPECT_EQ(model->numeric_data[model->numeric_adr[numeric]],
            folder.result.levels[0].plan.largest_timestep);
}

// What people read in the head of a level is what programs read in its number.
TEST(ExportScene, HeadTellsTheBoundOfTheNumber) {
  ExportOptions options;
  for (const ControllerKind controllers : {ControllerKind::kMocap, ControllerKind::kSlide}) {
    options.controllers = controllers;
    const ExportedFolder folder(SmallTwin(1), options);
    const ModelPtr model = folder.Load("scene.xml");
    const int numeric = Id(model, mjOBJ_NUMERIC, "block_critical_timestep");
    const std::string expected = fmt::format(
        "Largest stable time step of the {}: {:.4g} s. ",
        controllers == ControllerKind::kMocap ? "springs" : "controllers on slide joints",
        model->numeric_data[model->numeric_adr[numeric]]);
    const std::string level = ReadFile(folder.File("level0.xml"));
    EXPECT_NE(level.find(expected), std::string::npos) << expected << level.substr(0, 400);
  }
}

TEST(ExportScene, AsksForTheConeOfMujocosContacts) {
  Twin twin = SmallTwin(1);
  ExportOptions options;
  options.contact = ContactKind::kMujoco;
  twin.levels[0].system.contact.surface.cone = FrictionCone::kElliptic;
  EXPECT_EQ(ExportedFolder(twin, options).Load("scene.xml")->opt.cone, mjCONE_ELLIPTIC);
  twin.levels[0].system.contact.surface.cone = FrictionCone::kPyramidal;
  EXPECT_EQ(ExportedFolder(twin, options).Load("scene.xml")->opt.cone, mjCONE_PYRAMIDAL);
}

// The model of level 0, included in a scene with `defaults`.
ModelPtr Included(const ExportedFolder& folder, const std::string& defaults) {
  return folder.LoadText("<mujoco><default>" + defaults +
                         "</default><include file=\"level0.xml\"/></mujoco>");
}

TEST(ExportScene, DefaultsOfTheSceneDoNotChangeAnIncludedLevel) {
  const Twin twin = SmallTwin(1);
  const ExportedFolder folder(twin, {});
  const ModelPtr alone = Included(folder, "");
  const ModelPtr model = Included(folder, R"(
      <joint armature="0.01" frictionloss="0.1" stiffness="5" damping="1" range="-0.01 0.01"
             limited="true" springref="0.1" margin="0.1"/>
      <geom type="box" size="1 1 1" margin="0.01" condim="1" solimp="0.5 0.6 0.01"/>
      <tendon frictionloss="1" stiffness="3" damping="2" limited="true" range="0 0.01"/>)");
  ASSERT_EQ(model->nv, alone->nv);
  for (int i = 0; i < model->nv; ++i) {
    EXPECT_EQ(model->dof_armature[i], alone->dof_armature[i]);
    EXPECT_EQ(model->dof_frictionloss[i], alone->dof_frictionloss[i]);
    EXPECT_EQ(model->dof_damping[i], alone->dof_damping[i]);
    EXPECT_EQ(model->jnt_stiffness[i], alone->jnt_stiffness[i]);
    EXPECT_EQ(model->jnt_limited[i], alone->jnt_limited[i]);
  }
  for (int i = 0; i < model->ngeom; ++i) {
    EXPECT_EQ(model->geom_type[i], alone->geom_type[i]);
    EXPECT_EQ(model->geom_size[3 * i], alone->geom_size[3 * i]);
    if (model->geom_conaffinity[i] == 0) continue;  // a controller's, for pictures
    EXPECT_EQ(model->geom_condim[i], alone->geom_condim[i]);
    EXPECT_EQ(model->geom_margin[i], alone->geom_margin[i]);
    for (int j = 0; j < mjNIMP; ++j) {
      EXPECT_EQ(model->geom_solimp[mjNIMP * i + j], alone->geom_solimp[mjNIMP * i + j]);
    }
  }
  for (int i = 0; i < model->ntendon; ++i) {
    EXPECT_EQ(model->tendon_frictionloss[i], alone->tendon_frictionloss[i]);
    EXPECT_EQ(model->tendon_stiffness[i], alone->tendon_stiffness[i]);
    EXPECT_EQ(model->tendon_damping[i], alone->tendon_damping[i]);
    EXPECT_EQ(model->tendon_limited[i], alone->tendon_limited[i]);
  }
}

TEST(ExportScene, ActuatorsTakeControllersToTheirPlaceInOneStep) {
  const Twin twin = SmallTwin(1);
  const ExportedFolder folder(twin, {});
  const ModelPtr model = folder.Load("scene.xml");
  const DataPtr data = MakeData(*model);
  const int actuator = Id(model, mjOBJ_ACTUATOR, "block_controller_1_y");
  const int joint = Id(model, mjOBJ_JOINT, "block_controller_1_y");
  for (int step = 1; step <= 100; ++step) {
    data->ctrl[actuator] = 1e-4 * step;
    Step(*model, data.get());
    // springs push it aside by h^2 F / m: 1e-6 s^2 * 10 N / 1 kg
    EXPECT_NEAR(data->qpos[model->jnt_qposadr[joint]], 1e-4 * step, 1e-5);
  }
  EXPECT_NEAR(data->qvel[model->jnt_dofadr[joint]], 1e-4 / model->opt.timestep, 0.01);
}

TEST(ExportScene, NodesRestOnTheFloor) {
  Twin twin = SmallTwin(1);
  SpringMassSystem& system = twin.levels[0].system;
  system.contact.surface.friction = 0.8;
  system.position.row(2).array() += 0.1;
  // no controllers: nothing holds it
  system.controllers = 0;
  system.position.conservativeResize(3, system.mass.size());
  const int nodes = system.node_count();
  std::vector<int> kept;
  for (int e = 0; e < system.spring_count(); ++e) {
    if (system.springs[e][0] < nodes && system.springs[e][1] < nodes) kept.push_back(e);
  }
  SpringMassSystem free = system;
  free.springs.clear();
  for (const int e : kept) free.springs.push_back(system.springs[e]);
  free.stiffness = system.stiffness(kept).eval();
  free.dashpot = system.dashpot(kept).eval();
  free.rest_length = system.rest_length(kept).eval();
  system = free;
  const ExportedFolder folder(twin, {});
  const ModelPtr model = folder.Load("scene.xml");
  const DataPtr data = MakeData(*model);
  while (data->time < 2) Step(*model, data.get());
  EXPECT_GT(data->ncon, 4);
  EXPECT_EQ(data->contact[0].friction[0], 0.8);  // whatever the floor's is
  for (int node = 0; node < nodes; ++node) {
    const int body = Id(model, mjOBJ_BODY, "block_" + std::to_string(node));
    EXPECT_GT(data->xpos[3 * body + 2], 0.9 * 0.005);
    EXPECT_LT(mju_norm3(data->cvel + 6 * body + 3), 0.05);
  }
}

TEST(ExportScene, EffectsAreCarriedByTendons) {
  Twin twin = SmallTwin(1);
  SpringMassSystem& system = twin.levels[0].system;
  system.effects.push_back({"stiffening", Eigen::VectorXd::Constant(1, 3)});
  system.effects.push_back({"air_drag", GetEffect("air_drag").Starts(system)[0]});
  ExportOptions options;
  options.springs = SpringKind::kTendon;
  const ExportedFolder folder(twin, options);
  const ModelPtr model = folder.Load("scene.xml");
  const double k = system.stiffness[5], length = system.rest_length[5];
  EXPECT_EQ(model->tendon_stiffness[5], k);
  EXPECT_DOUBLE_EQ(model->tendon_stiffnesspoly[mjNPOLY * 5 + 1], 3 * k / (length * length));
  const std::vector<std::string>& differences = folder.result.levels[0].plan.differences;
  ASSERT_EQ(differences.size(), 1u);
  EXPECT_EQ(differences[0].rfind("effect air_drag is left out: ", 0), 0u);
}

TEST(ExportScene, OddCharactersInATwinsName) {
  Twin twin = SmallTwin(1);
  twin.name = "a b<&\"'/--\xc3\xa9%";
  const ExportedFolder folder(twin, {});
  const ModelPtr model = folder.Load("scene.xml");
  EXPECT_GE(Id(model, mjOBJ_BODY, "a_b_____--____0"), 0);
}

TEST(ExportScene, FloorIsTheGroundOfTheRecordings) {
  Twin twin = SmallTwin(1);
  const Eigen::Vector3d normal = Eigen::Vector3d(1, 2, 4).normalized();
  Eigen::Vector4d plane;
  plane << normal, -0.7;
  twin.ground = {.known = true, .plane = plane};
  const ExportedFolder tilted(twin, {});
  EXPECT_TRUE(tilted.result.warnings.empty());
  const ModelPtr model = tilted.Load("scene.xml");
  const DataPtr data = MakeData(*model);
  mj_forward(model.get(), data.get());
  const std::vector<Eigen::Vector4d> grounds = GroundsOf(*model, *data);
  ASSERT_EQ(grounds.size(), 1u);
  EXPECT_LT((grounds[0] - plane).norm(), 1e-6);  // as many digits as MJCF gets

  twin.ground.plane.reset();
  const ExportedFolder none(twin, {});
  EXPECT_TRUE(none.result.warnings.empty());
  EXPECT_EQ(Id(none.Load("scene.xml"), mjOBJ_GEOM, "floor"), -1);
}

// A guess, where the twin's file does not say.
TEST(ExportScene, FloorLiesBelowAndAcrossGravity) {
  Twin twin = SmallTwin(1);
  twin.gravity = Eigen::Vector3d(0, 9.81, 0);  // y points down
  const ExportedFolder folder(twin, {});
  ASSERT_EQ(folder.result.warnings.size(), 1u);
  EXPECT_NE(folder.result.warnings[0].find("does not say what ground"), std::string::npos);
  const ModelPtr model = folder.Load("scene.xml");
  const int floor = Id(model, mjOBJ_GEOM, "floor");
  EXPECT_EQ(model->opt.gravity[1], 9.81);
  // the lowest points are at y = 0.06, a radius of 0.005 above the floor
  EXPECT_NEAR(model->geom_pos[3 * floor + 1], 0.065, 1e-12);
  const DataPtr data = MakeData(*model);
  mj_forward(model.get(), data.get());
  EXPECT_NEAR(data->geom_xmat[9 * floor + 5], -1, 1e-12);  // its normal's y
}

}  // namespace
}  // namespace physpring
