// SPDX-License-Identifier: Apache-2.0
// The sensors physpring.force as MuJoCo handles them: frames, steps, copies, resets, and what is
// refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/felt_scene.h"
#include "twin/error.h"

namespace physpring {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

// A pyramid that falls on a plate, askew, as it hits it.
struct Fall : Felt {
  Fall()
      : Felt(Mjcf(Pyramid(), {.contact = true, .timestep = 2e-3, .substep = 0.5e-3, .world = R"(
      <body name="plate" pos="0.02 0 -0.03"><freejoint/>
        <geom type="box" size="0.08 0.08 0.02" mass="0.4"/>
        <site name="at" pos="0.01 0.02 0.03" euler="20 30 40"/></body>)"},
                  OfBody("plate") +
                      R"(<plugin plugin="physpring.force" objtype="site" objname="at"/>)")) {
    data->qvel[2] = 1;
    Run(5);
    mj_forward(model.get(), data.get());  // the first impact
  }
};

TEST(ForceReading, SiteTurnsAndShiftsWhatItsBodyFeels) {
  const Fall fall;
  const mjData* d = fall.data.get();
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> axes(d->site_xmat);
  const Vector3d arm =
      Eigen::Map<const Vector3d>(d->xipos + 3) - Eigen::Map<const Vector3d>(d->site_xpos);
  const Vector3d force = fall.Of(0).head<3>(), torque = fall.Of(0).tail<3>();
  EXPECT_GT(force.norm(), 1);
  EXPECT_LT((axes * fall.Of(1).head<3>() - force).norm(), 1e-12);
  EXPECT_LT((axes * fall.Of(1).tail<3>() - torque - arm.cross(force)).norm(), 1e-12);
}

TEST(ForceReading, ForwardForetellsTheStep) {
  Fall fall;
  const Eigen::VectorXd foretold = fall.All();
  fall.Run(1);
  EXPECT_GT(foretold.norm(), 1);
  EXPECT_EQ(foretold, fall.All());
}

TEST(ForceReading, CopiesFeelTheSame) {
  Fall fall;
  const DataPtr copy(mj_copyData(nullptr, fall.model.get(), fall.data.get()));
  EXPECT_GT(fall.All().norm(), 1);
  for (int i = 0; i < 12; ++i) EXPECT_EQ(copy->sensordata[i], fall.All()[i]);
  fall.Run(3);
  for (int i = 0; i < 3; ++i) mj_step(fall.model.get(), copy.get());
  for (int i = 0; i < 12; ++i) EXPECT_EQ(copy->sensordata[i], fall.All()[i]);
}

TEST(ForceReading, ResetForgets) {
  Fall fall;
  mj_resetData(fall.model.get(), fall.data.get());
  EXPECT_EQ(fall.All().norm(), 0);
  fall.data->qpos[2] = -1;  // the plate, far below
  mj_forward(fall.model.get(), fall.data.get());
  EXPECT_EQ(fall.All().norm(), 0);
}

TEST(ForceReading, NothingIsFeltWithoutPassiveForces) {
  Fall fall;
  fall.model->opt.disableflags |= mjDSBL_SPRING | mjDSBL_DAMPER;
  mj_forward(fall.model.get(), fall.data.get());
  EXPECT_EQ(fall.All().norm(), 0);
}

// The error with which the pyramid and a sensor do not compile.
std::string Refusal(const std::string& sensor, bool has_twin = true) {
  try {
    const LevelSceneOptions options{.plugin_springs = false, .contact = has_twin};
    CompileMjcf(Mjcf(Pyramid(), options, sensor));
  } catch (const Error& error) {
    return error.what();
  }
  return "it compiles";
}

TEST(ForceReading, RefusalsNameTheSensor) {
  EXPECT_THAT(
      Refusal(R"(<plugin name="pad" plugin="physpring.force"/>)"),
      HasSubstr("physpring.force: sensor 'pad' has another objtype, expected body or site"));
  EXPECT_THAT(Refusal(R"(<plugin plugin="physpring.force" objtype="xbody" objname="rope_0"/>)"),
              HasSubstr("physpring.force: sensor 0 has another objtype, expected body or site"));
  EXPECT_THAT(Refusal(R"(<plugin plugin="physpring.force" objtype="body" objname="rope_0"
                          reftype="body" refname="world"/>)"),
              HasSubstr("sensor 0 has a reference, expected none"));
  EXPECT_THAT(Refusal(OfBody("rope")),
              HasSubstr("sensor 0: body 'rope' is the parent of 4 nodes, expected the attribute "
                        "'nodes' with that number"));
  EXPECT_THAT(Refusal(OfNodes("rope", 3)), HasSubstr("is the parent of 4 nodes"));
  EXPECT_THAT(Refusal(OfNodes("rope_0", 4)),
              HasSubstr("body 'rope_0' is no parent of nodes, expected no attribute 'nodes'"));
  EXPECT_THAT(Refusal(R"(<plugin plugin="physpring.force" objtype="site" objname="rope_0">
                          <config key="nodes" value="4"/></plugin>)"),
              HasSubstr("sensor 0 is of a site, expected no attribute 'nodes'"));
  EXPECT_THAT(Refusal(OfBody("rope", R"(<config key="nodes" value="-4"/>)")),
              HasSubstr("physpring.force: attribute 'nodes' is '-4', expected how many nodes"));
  EXPECT_THAT(Refusal(OfBody("world"), false),
              HasSubstr("physpring.force: the model has no twin, expected one with "
                        "physpring.springs or physpring.contact"));
  EXPECT_THAT(Refusal(OfBody("rope_0")), HasSubstr("it compiles"));
}

}  // namespace
}  // namespace physpring
