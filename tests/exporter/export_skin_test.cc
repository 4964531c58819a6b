// SPDX-License-Identifier: Apache-2.0
// How exported levels look: the skin of a body, a mesh that it wears, the tendon along a rod.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <fstream>
#include <set>

#include "rollout/mujoco_log.h"
#include "tests/support/exported_folder.h"
#include "tests/support/small_twin.h"
#include "tests/support/temporary_folder.h"
#include "twin/error.h"
#include "twin/hierarchy.h"

namespace physpring {
namespace {

int Id(const ModelPtr& model, mjtObj type, const std::string& name) {
  return mj_name2id(model.get(), type, name.c_str());
}

// The vertices of the skin as MuJoCo draws them.
Eigen::MatrixX3f SkinVertices(const mjModel& model, mjData* data) {
  mj_forward(&model, data);
  mjvScene scene;
  mjvOption option;
  mjvCamera camera;
  mjv_defaultCamera(&camera);
  mjv_defaultOption(&option);
  mjv_defaultScene(&scene);
  mjv_makeScene(&model, &scene, 10000);
  mjv_updateScene(&model, data, &option, nullptr, &camera, mjCAT_ALL, &scene);
  const Eigen::Map<const Eigen::Matrix3Xf> vertices(scene.skinvert, 3, model.nskinvert);
  const Eigen::MatrixX3f rows = vertices.transpose();
  mjv_freeScene(&scene);
  return rows;
}

TEST(ExportSkin, SkinTurnsWithTheNodes) {
  const Twin twin = SmallTwin(2);
  const ExportedFolder folder(twin, {});
  for (const ExportedLevel& level : folder.result.levels) {
    const ModelPtr model = folder.Load(level.scene);
    ASSERT_EQ(model->nskin, 1);
    const DataPtr data = MakeData(*model);
    const Eigen::MatrixX3f before = SkinVertices(*model, data.get());
    const Eigen::AngleAxisd turn(1, Eigen::Vector3d(1, 2, 3).normalized());
    const SpringMassSystem& system = level.plan.system();
    const Points nodes = system.position.leftCols(system.node_count());
    Eigen::Map<Points>(data->qpos, 3, nodes.cols()) = turn.matrix() * nodes - nodes;
    const Eigen::MatrixX3f after = SkinVertices(*model, data.get());
    const Eigen::MatrixX3f expected = before * turn.matrix().transpose().cast<float>();
    // by the regularisation of the weights, in parts of the nodes' distance; level 1 is one layer
    // of nodes, which leaves open how what lies above and below it turns
    const double difference = (after - expected).rowwise().norm().maxCoeff();
    EXPECT_LT(difference, (level.plan.level == 0 ? 0.2 : 0.5) * 0.02);
  }
}

// The box of the small twin's nodes.
constexpr char kBox[] =
    "v 0 0 0\nv 0.08 0 0\nv 0.08 0.06 0\nv 0 0.06 0\n"
    "v 0 0 0.02\nv 0.08 0 0.02\nv 0.08 0.06 0.02\nv 0 0.06 0.02\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

TEST(ExportSkin, AMeshIsWornByAllLevels) {
  const Twin twin = SmallTwin(2);
  const TemporaryFolder files;
  std::ofstream(files.File("m.obj")) << kBox;
  ExportOptions options;
  options.mesh = files.File("m.obj");
  const ExportedFolder folder(twin, options);
  for (const ExportedLevel& level : folder.result.levels) {
    EXPECT_EQ(folder.Load(level.scene)->nskinvert, 8);
  }
}

TEST(ExportSkin, WhatOfAMeshWasGuessedIsSaid) {
  const TemporaryFolder files;
  std::string box = kBox;
  for (std::size_t i = box.find("0.0"); i != std::string::npos; i = box.find("0.0", i)) {
    box.replace(i, 3, "");  // 0.08 m are 8 cm
  }
  std::ofstream(files.File("m.obj")) << box;
  ExportOptions options;
  options.mesh = files.File("m.obj");
  const std::vector<std::string> warnings = ExportTwin(SmallTwin(1), options, "").warnings;
  ASSERT_FALSE(warnings.empty());
  EXPECT_EQ(warnings[0].rfind(options.mesh + ": taken as centimetres, because ", 0), 0u);
}

TEST(ExportSkin, AMeshMustBeWhereTheTwinIs) {
  const TemporaryFolder files;
  std::ofstream(files.File("m.obj")) << "v 0 0 5\nv 0.08 0 5\nv 0 0.06 5\nf 1 2 3\n";
  ExportOptions options;
  options.mesh = files.File("m.obj");
  const Twin twin = SmallTwin(1);
  try {
    ExportTwin(twin, options, "");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(
        error.what(),
        options.mesh +
            ": the measured points are 5 m from the mesh on average, expected less than 0.01 m "
            "(their spacing is 0.02 m); is the mesh in another frame or unit? the mesh measures "
            "0.08 "
            "x 0.06 x 0 m around (0.04, 0.03, 5), the points 0.08 x 0.06 x 0.02 m around (0.04, "
            "0.03, "
            "0.01)");
  }
}

TEST(ExportSkin, ARodIsDrawnAlongItsOrder) {
  Twin twin = SmallTwin(2);
  twin.rod = PlainRod(Eigen::VectorXd::LinSpaced(42, 0, 1));
  SpreadRod(&twin);
  const ExportedFolder folder(twin, {});
  const ModelPtr model = folder.Load("scene.xml");
  EXPECT_EQ(model->nskin, 0);
  const int rod = Id(model, mjOBJ_TENDON, "block_rod");
  ASSERT_EQ(rod, model->ntendon - 1);  // after the springs
  EXPECT_EQ(model->tendon_num[rod], 40);
  EXPECT_EQ(model->tendon_stiffness[rod], 0);
}

TEST(ExportSkin, ARodWithBranchesIsDrawnAlongEach) {
  Twin twin = SmallTwin(2);
  RodEdges edges;
  for (int i = 1; i < 42; ++i) edges.push_back({i == 30 ? 10 : i - 1, i});
  twin.rod = RodOfEdges(edges, twin.levels[0].system.position);
  SpreadRod(&twin);
  const ExportedFolder folder(twin, {});
  const ModelPtr model = folder.Load("scene.xml");
  std::multiset<int> sites;
  for (const char* name : {"block_rod", "block_rod1", "block_rod2"}) {
    const int tendon = Id(model, mjOBJ_TENDON, name);
    ASSERT_GE(tendon, 0) << name;
    sites.insert(model->tendon_num[tendon]);
  }
  EXPECT_EQ(sites, (std::multiset{11, 11, 20}));  // without the two controllers
}

}  // namespace
}  // namespace physpring
