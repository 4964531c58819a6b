// SPDX-License-Identifier: Apache-2.0
// Other looks change what is drawn and nothing that moves.
#include "rollout/looks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rollout/scene.h"

namespace physpring {
namespace {

ModelPtr Scene() {
  const char* const kScene = R"(
      <mujoco>
        <asset><material name="m" rgba="0.5 0.5 0.5 0.9"/></asset>
        <worldbody>
          <light pos="0 0 2"/>
          <camera name="front" pos="0.05 -0.4 0.3" xyaxes="1 0 0 0 0.6 0.8" fovy="45"/>
          <body><freejoint/><geom size="0.1" material="m"/></body>
        </worldbody>
      </mujoco>)";
  mjVFS files;
  mj_defaultVFS(&files);
  mj_addBufferVFS(&files, "scene.xml", kScene, static_cast<int>(std::string(kScene).size()));
  char error[200] = "";
  ModelPtr model(mj_loadXML("scene.xml", &files, error, sizeof error));
  mj_deleteVFS(&files);
  EXPECT_TRUE(model) << error;
  return model;
}

TEST(Looks, StayWithinTheirBoundsAndDifferBySeed) {
  const ModelPtr before = Scene(), one = Scene(), other = Scene(), again = Scene();
  VaryLooks(1, one.get());
  VaryLooks(2, other.get());
  VaryLooks(1, again.get());
  for (int colour = 0; colour < 3; ++colour) {
    EXPECT_NEAR(one->mat_rgba[colour], 0.5, 0.15);
    EXPECT_NE(one->mat_rgba[colour], other->mat_rgba[colour]);
    EXPECT_EQ(one->mat_rgba[colour], again->mat_rgba[colour]);
    EXPECT_NEAR(one->light_pos[colour], before->light_pos[colour], 0.3);
    EXPECT_NEAR(one->cam_pos[colour], before->cam_pos[colour], 0.01);
    EXPECT_NE(one->cam_pos[colour], before->cam_pos[colour]);
  }
  EXPECT_EQ(one->mat_rgba[3], 0.9F);
  EXPECT_NEAR(one->cam_fovy[0], 45, 1.5);
  const double cosine = mju_dot(one->cam_quat, before->cam_quat, 4);  // of half the angle
  EXPECT_LT(2 * std::acos(std::min(1.0, cosine)), std::sqrt(3) * 1.5 * mjPI / 180);
}

TEST(Looks, WhatHasOneColourKeepsOneColour) {
  const ModelPtr model = Scene();
  std::copy_n(model->mat_rgba, 4, model->geom_rgba);  // of another kind, the same colour
  VaryLooks(3, model.get());
  for (int colour = 0; colour < 4; ++colour) {
    EXPECT_EQ(model->geom_rgba[colour], model->mat_rgba[colour]);
  }
}

TEST(Looks, NothingThatMovesChanges) {
  const ModelPtr before = Scene(), after = Scene();
  VaryLooks(1, after.get());
  const DataPtr a = MakeData(*before), b = MakeData(*after);
  for (int step = 0; step < 50; ++step) {
    mj_step(before.get(), a.get());
    mj_step(after.get(), b.get());
  }
  for (int i = 0; i < before->nq; ++i) EXPECT_EQ(a->qpos[i], b->qpos[i]) << i;
}

}  // namespace
}  // namespace physpring
