// SPDX-License-Identifier: Apache-2.0
#include "rollout/mocap_path.h"

#include <gtest/gtest.h>

#include "rollout/scene.h"
#include "tests/support/scene_test.h"

namespace physpring {
namespace {

// Two bodies; the second one only turns: by 90 degrees about z, the sign of its quaternion flipped.
constexpr char kScene[] = R"(
  <mujoco>
    <worldbody>
      <body mocap="true"><geom size="0.1"/></body>
      <body mocap="true" pos="5 0 0"><geom size="0.1"/></body>
    </worldbody>
    <keyframe>
      <key time="-1" mpos="0 0 1  5 0 0"/>
      <key time="1" mpos="2 0 1  5 0 0" mquat="1 0 0 0  -0.7071 0 0 -0.7071"/>
      <key time="2" mpos="3 0 0  5 0 0" mquat="1 0 0 0  -0.7071 0 0 -0.7071"/>
      <key time="4" mpos="3 0 4  5 0 0" mquat="1 0 0 0  -0.7071 0 0 -0.7071"/>
    </keyframe>
  </mujoco>)";

class MocapPathTest : public SceneTest {
 protected:
  Eigen::Vector3d PositionAt(double time, int body = 0) {
    path_.Place(time, data_.get());
    return Eigen::Map<const Eigen::Vector3d>(data_->mocap_pos + 3 * body);
  }

  std::vector<std::string> warnings_;
  ModelPtr model_ = LoadScene(WriteScene(kScene), &warnings_);
  DataPtr data_ = MakeData(*model_);
  MocapPath path_{*model_, "scene"};
};

TEST_F(MocapPathTest, PassesThroughItsKeys) {
  EXPECT_TRUE(PositionAt(-1).isApprox(Eigen::Vector3d(0, 0, 1)));
  EXPECT_TRUE(PositionAt(1).isApprox(Eigen::Vector3d(2, 0, 1)));
  EXPECT_TRUE(PositionAt(2).isApprox(Eigen::Vector3d(3, 0, 0)));
  EXPECT_TRUE(PositionAt(4).isApprox(Eigen::Vector3d(3, 0, 4)));
}

TEST_F(MocapPathTest, StandsStillBeforeAndAfter) {
  EXPECT_TRUE(PositionAt(-7).isApprox(Eigen::Vector3d(0, 0, 1)));
  EXPECT_TRUE(PositionAt(9).isApprox(Eigen::Vector3d(3, 0, 4)));
}

TEST_F(MocapPathTest, VelocityIsContinuousAndZeroAtTheEnds) {
  const double h = 1e-6;
  for (const double key : {-1.0, 1.0, 2.0, 4.0}) {
    const Eigen::Vector3d before = (PositionAt(key) - PositionAt(key - h)) / h;
    const Eigen::Vector3d after = (PositionAt(key + h) - PositionAt(key)) / h;
    // curvature times h
    EXPECT_LT((after - before).norm(), 1e-4) << "at " << key;
  }
}

TEST_F(MocapPathTest, NeverLeavesTheKeysAroundIt) {
  for (int step = 0; step < 500; ++step) {
    const double time = -1 + 0.01 * step;
    const Eigen::Vector3d position = PositionAt(time);
    EXPECT_GE(position[2], -1e-12);
    // between equal keys
    const double expected = time < 1 ? 1 : 3;
    if (time < 1 || time > 2) {
      EXPECT_NEAR(time < 1 ? position[2] : position[0], expected, 1e-12);
    }
  }
}

TEST_F(MocapPathTest, TurnsTheShorterWay) {
  path_.Place(0, data_.get());
  const double* quaternion = data_->mocap_quat + 4;
  // half way by symmetry: 45 degrees about z
  EXPECT_NEAR(std::abs(quaternion[0]), std::cos(mjPI / 8), 1e-4);
  EXPECT_NEAR(std::abs(quaternion[3]), std::sin(mjPI / 8), 1e-4);
}

TEST_F(MocapPathTest, VariationShiftsAllBodiesAlikeWithinItsBounds) {
  path_.Vary(0.1, 3);
  EXPECT_TRUE(PositionAt(-1).isApprox(Eigen::Vector3d(0, 0, 1)));
  const Eigen::Vector3d shift = PositionAt(2) - Eigen::Vector3d(3, 0, 0);
  EXPECT_GT(shift.cwiseAbs().maxCoeff(), 0);
  EXPECT_LE(shift.cwiseAbs().maxCoeff(), 0.1);
  EXPECT_TRUE((PositionAt(2, 1) - Eigen::Vector3d(5, 0, 0)).isApprox(shift));
}

}  // namespace
}  // namespace physpring
