// SPDX-License-Identifier: Apache-2.0
#include "rollout/controller_replay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rollout/plugin_library.h"
#include "tests/support/exported_folder.h"
#include "tests/support/small_twin.h"
#include "twin/error.h"
#include "twin/grasps.h"
#include "twin/lift.h"
#include "twin/predict.h"

namespace physpring {
namespace {

using testing::HasSubstr;

// In the scene's time step, which is the trainer's sub-step, without contact.
class ControllerReplayTest : public testing::TestWithParam<SpringKind> {
 protected:
  ControllerReplayTest() : folder_(twin_, Options()) { LoadPluginLibrary(PHYSPRING_PLUGIN); }

  static ExportOptions Options() {
    ExportOptions options;
    options.springs = GetParam();
    options.contact = ContactKind::kNone;
    return options;
  }

  // Without a ground, as its recording is.
  static Twin GroundlessTwin() {
    Twin twin = SmallTwin(2);
    twin.ground = {.known = true, .plane = {}};
    return twin;
  }

  const Twin twin_ = GroundlessTwin();
  const Recording recording_ = RecordingOfMotion(twin_, 12);
  const ExportedFolder folder_;
};

TEST_P(ControllerReplayTest, MovesAsTheTrainerPredicts) {
  const ControllerReplay replay =
      ReplayControllers(folder_.File("scene.xml"), recording_, nullptr, {});
  EXPECT_EQ(replay.level, 0);
  EXPECT_EQ(replay.warnings, std::vector<std::string>());
  const std::vector<Points> predicted = Predict(twin_, 0, recording_, {});
  ASSERT_EQ(replay.particles.size(), predicted.size());
  EXPECT_GT((predicted.back() - predicted[0]).cwiseAbs().maxCoeff(), 1e-2);
  for (std::size_t t = 0; t < predicted.size(); ++t) {
    EXPECT_LT((replay.particles[t] - predicted[t]).cwiseAbs().maxCoeff(), 1e-9) << "frame " << t;
  }
}

TEST_P(ControllerReplayTest, LiftsALevelWithItsTwin) {
  const std::string scene = folder_.File("scene_level1.xml");
  const ControllerReplay replay = ReplayControllers(scene, recording_, &twin_, {});
  EXPECT_EQ(replay.level, 1);
  const std::vector<Points> predicted = Predict(twin_, 1, recording_, {});
  const Lift lift(twin_, 1, recording_.start.leftCols(recording_.particle_count()));
  for (std::size_t t = 0; t < predicted.size(); ++t) {
    EXPECT_LT((replay.particles[t] - lift.Apply(predicted[t])).cwiseAbs().maxCoeff(), 1e-9);
  }
}

// Controller 1 takes hold in frame 5; tendons would hold on from the start.
TEST_P(ControllerReplayTest, TakesHoldAsTheRecordingDoes) {
  Recording recording = recording_;
  recording.held.resize(recording.frame_count(), 2);
  recording.held.setConstant(true);
  recording.held.col(1).head(5).setConstant(false);
  FindShapesWhenHeld(&recording);
  const auto replay = [&](int level) {
    const std::string scene = folder_.File(level == 0 ? "scene.xml" : "scene_level1.xml");
    return ReplayControllers(scene, recording, &twin_, {}).particles;
  };
  if (GetParam() == SpringKind::kTendon) {
    EXPECT_THROW(replay(0), Error);
    return;
  }
  const Lift lift(twin_, 1, recording_.start.leftCols(recording_.particle_count()));
  for (int level : {0, 1}) {
    const std::vector<Points> replayed = replay(level),
                              predicted = Predict(twin_, level, recording, {});
    for (std::size_t t = 0; t < predicted.size(); ++t) {
      const Points particles = level == 0 ? predicted[t] : lift.Apply(predicted[t]);
      EXPECT_LT((replayed[t] - particles).cwiseAbs().maxCoeff(), 1e-9) << level << " " << t;
    }
  }
}

// An object that is carried far below where it starts, and below height 0: no floor is in its way.
TEST_P(ControllerReplayTest, GoesWhereTheRecordingHasNoGround) {
  Recording recording = recording_;
  for (int t = 0; t < recording.frame_count(); ++t) {
    recording.controllers[t].row(2).array() -= 0.01 * t;
  }
  ExportOptions options = Options();
  options.contact = ContactKind::kAuto;
  const ExportedFolder folder(twin_, options);
  const ControllerReplay replay =
      ReplayControllers(folder.File("scene.xml"), recording, nullptr, {});
  EXPECT_EQ(replay.warnings, std::vector<std::string>());
  const std::vector<Points> predicted = Predict(twin_, 0, recording, {});
  EXPECT_LT(predicted.back().row(2).minCoeff(), -0.05);
  EXPECT_LT((replay.particles.back() - predicted.back()).cwiseAbs().maxCoeff(), 1e-3);
}

TEST_P(ControllerReplayTest, SaysThatTheRecordingHasAnotherGround) {
  Recording recording = recording_;
  recording.ground = Eigen::Vector4d(0, 0, 1, -0.3);
  const ControllerReplay replay =
      ReplayControllers(folder_.File("scene.xml"), recording, nullptr, {});
  ASSERT_EQ(replay.warnings.size(), 1u);
  EXPECT_THAT(replay.warnings[0], HasSubstr("its ground is none, that of recording"));
  EXPECT_THAT(replay.warnings[0], HasSubstr("is 0 x + 0 y + 1 z = -0.3 m"));
  // and the other way round
  Twin grounded = twin_;
  grounded.ground.plane = recording.ground;
  const ExportedFolder folder(grounded, Options());
  EXPECT_EQ(ReplayControllers(folder.File("scene.xml"), recording, nullptr, {}).warnings,
            std::vector<std::string>());
  EXPECT_EQ(ReplayControllers(folder.File("scene.xml"), recording_, nullptr, {}).warnings.size(),
            1u);
}

INSTANTIATE_TEST_SUITE_P(Springs, ControllerReplayTest,
                         testing::Values(SpringKind::kTendon, SpringKind::kPlugin),
                         [](const auto& kind) {
                           return kind.param == SpringKind::kTendon ? "Tendons" : "Plugin";
                         });

std::string Message(const std::string& scene, const Recording& recording, const Twin* twin) {
  try {
    ReplayControllers(scene, recording, twin, {});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(ControllerReplayErrors, SayWhatDoesNotFit) {
  const Twin twin = SmallTwin(2);
  const ExportedFolder folder(twin, {});
  Recording recording = RecordingOfMotion(twin, 3);
  EXPECT_THAT(Message(folder.File("scene_level1.xml"), recording, nullptr),
              HasSubstr("is it of this object? If it is, a level above 0 needs its twin"));
  const Twin other = SmallTwin(1);
  EXPECT_THAT(Message(folder.File("scene_level1.xml"), recording, &other),
              HasSubstr("as no level of twin"));
  for (Points& frame : recording.controllers) frame = Points(frame.leftCols(1));
  EXPECT_THAT(Message(folder.File("scene.xml"), recording, nullptr),
              HasSubstr("has 2 controllers, but recording"));
  EXPECT_THAT(
      Message(std::string(PHYSPRING_SOURCE_DIR) + "/models/demo/rope.xml", recording, nullptr),
      HasSubstr("holds 0 objects written by physpring export, expected 1"));
}

}  // namespace
}  // namespace physpring
