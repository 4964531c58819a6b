// SPDX-License-Identifier: Apache-2.0
// Splats in MuJoCo's pictures: in the right place, before and behind what MuJoCo draws.
#include "rollout/splat_layer.h"

#include <gtest/gtest.h>

#include "rollout/gl_camera.h"
#include "rollout/painter.h"
#include "rollout/plugin_library.h"
#include "rollout/simulation.h"
#include "splats/splat_file.h"
#include "tests/support/drawing.h"
#include "tests/support/small_task.h"
#include "twin/error.h"

namespace physpring {
namespace {

constexpr int kWidth = 160, kHeight = 120;

class SplatLayerTest : public ::testing::Test {
 protected:
  SplatLayerTest() {
    LoadPluginLibrary(PHYSPRING_PLUGIN);
    const Twin twin = ReadTask(task_.path()).twin;
    const SpringMassSystem& system = twin.levels[0].system;
    WriteSplats(Green(system.position.leftCols(system.node_count())), task_.File("block.ply"));
    task_.Change(R"("settle": 5)", R"("settle": 5, "splats": {"file": "block.ply"})");
    read_ = ReadTask(task_.path());
  }

  void SetUp() override {
    if (const std::string why = WhyNoDrawing(); !why.empty()) GTEST_SKIP() << why;
    std::vector<std::string> warnings;
    model_ = MakeTaskModel(read_, 0, &warnings);
    simulation_.emplace(model_);
    simulation_->Reset(StartOf(read_, 1, 0, {}));
    model_.model->stat.extent = 2;  // m: marks are large enough to be seen
    PreparePictures(PictureQuality::kFast, kWidth, kHeight, model_.model.get());
  }

  // An opaque ball of 8 mm about each node.
  static Splats Green(const Points& nodes) {
    Splats splats;
    const int count = static_cast<int>(nodes.cols());
    splats.position = nodes.cast<float>();
    splats.log_scale.setConstant(3, count, std::log(0.008F));
    splats.rotation = Eigen::Vector4f(1, 0, 0, 0).replicate(1, count);
    splats.logit.setConstant(count, 8);
    splats.harmonics = Eigen::Vector3f(-1.7F, 1.7F, -1.7F).replicate(1, count);
    return splats;
  }

  Image Paint(const SplatLayer* splats, const Points& marks) {
    DataPtr data = MakeData(*model_.model);
    mj_copyData(data.get(), model_.model.get(), &simulation_->data());
    PlaceForDrawing(*model_.model, data.get());
    Painter painter(*model_.model, PictureQuality::kFast, kWidth, kHeight, splats);
    const mjvCamera view = FindCamera(*model_.model, "front", "scene");
    camera_ =
        PinholeOf(mjv_camera2GLCamera(model_.model.get(), data.get(), &view), kWidth, kHeight);
    return painter.Paint(data.get(), view, marks);
  }

  Eigen::Vector2d PixelOf(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d t = camera_.axes * point + camera_.shift;
    return {camera_.fx * t.x() / t.z() + camera_.cx, camera_.fy * t.y() / t.z() + camera_.cy};
  }

  static Eigen::Vector3i Colour(const Image& image, const Eigen::Vector2d& pixel) {
    const auto x = static_cast<std::size_t>(pixel.x()), y = static_cast<std::size_t>(pixel.y());
    const unsigned char* rgb = &image.rgb[3 * (y * kWidth + x)];
    return {rgb[0], rgb[1], rgb[2]};
  }
  static bool IsGreen(const Eigen::Vector3i& rgb) { return rgb[1] > rgb[0] + 80; }

  SmallTask task_;
  Task read_;
  TaskModel model_;
  std::optional<Simulation> simulation_;
  PinholeCamera camera_;
};

TEST_F(SplatLayerTest, TheCameraIsMujocos) {
  const Image plain = Paint(nullptr, Points(3, 0));
  const Eigen::Vector3d place(0.1, 0.02, 0.12);  // in the air
  const Image marked = Paint(nullptr, place);
  Eigen::Vector2d sum(0, 0);
  int count = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Eigen::Vector2d pixel(x + 0.5, y + 0.5);
      if (Colour(plain, pixel) == Colour(marked, pixel)) continue;
      sum += pixel;
      ++count;
    }
  }
  ASSERT_GT(count, 3);
  EXPECT_LT((sum / count - PixelOf(place)).norm(), 1.0);  // pixels; a few are lit
}

TEST_F(SplatLayerTest, SplatsLieWhereTheNodesAre) {
  const SplatLayer splats(model_);
  const Image image = Paint(&splats, Points(3, 0));
  const Points nodes = simulation_->Nodes();
  int green = 0;
  for (const auto& node : nodes.colwise()) green += IsGreen(Colour(image, PixelOf(node))) ? 1 : 0;
  EXPECT_GT(green, nodes.cols() / 2);  // the hand is before some of them
}

TEST_F(SplatLayerTest, WhatIsNearerHidesThemAndTheyHideWhatIsFarther) {
  const SplatLayer splats(model_);
  Paint(&splats, Points(3, 0));
  const Eigen::Vector3d middle = simulation_->Nodes().rowwise().mean();
  const Eigen::Vector3d along = (middle - camera_.centre()).normalized();
  const Eigen::Vector2d pixel = PixelOf(middle);
  Points marks(3, 1);
  marks.col(0) = middle - 0.15 * along;
  EXPECT_FALSE(IsGreen(Colour(Paint(&splats, marks), pixel)));
  marks.col(0) = middle;  // in the block
  EXPECT_TRUE(IsGreen(Colour(Paint(&splats, marks), pixel)));
  // it is seen where the splats are clear
  Splats clear = *read_.splats.object;
  clear.logit.setConstant(-9);
  read_.splats.object = std::make_shared<Splats>(clear);
  const SplatLayer no_splats(model_);
  EXPECT_NE(Colour(Paint(&no_splats, marks), pixel),
            Colour(Paint(&no_splats, Points(3, 0)), pixel));
}

TEST_F(SplatLayerTest, SplatsElsewhereAreAWarning) {
  Splats elsewhere = *read_.splats.object;
  elsewhere.position.row(0).array() += 3;
  Task task = read_;
  task.splats.object = std::make_shared<Splats>(elsewhere);
  std::vector<std::string> warnings;
  MakeTaskModel(task, 0, &warnings);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("another place"), std::string::npos) << warnings[0];
}

// A background of one large splat, behind all that is in the scene.
TEST_F(SplatLayerTest, ABackgroundIsBehindWithTheObjectBeforeIt) {
  const Image before = Paint(nullptr, Points(3, 0));
  const Eigen::Vector3d middle = simulation_->Nodes().rowwise().mean();
  const Eigen::Vector3d along = (middle - camera_.centre()).normalized();
  Splats wall = Green(Points(middle + 0.05 * along));
  wall.log_scale.setConstant(std::log(0.3F));
  wall.harmonics = Eigen::Vector3f(-1.7F, -1.7F, 1.7F);
  read_.splats.background = std::make_shared<Splats>(wall);
  const auto is_blue = [](const Eigen::Vector3i& rgb) { return rgb[2] > rgb[1] + 80; };
  const SplatLayer both(model_);
  EXPECT_TRUE(both.has_object());
  const Image image = Paint(&both, Points(3, 0));
  EXPECT_TRUE(IsGreen(Colour(image, PixelOf(middle))));
  const Eigen::Vector2d above = PixelOf(middle + 0.1 * Eigen::Vector3d::UnitZ());
  EXPECT_FALSE(is_blue(Colour(before, above)));
  EXPECT_TRUE(is_blue(Colour(image, above)));
  read_.splats.object = nullptr;
  const SplatLayer alone(model_);
  EXPECT_FALSE(alone.has_object());
}

TEST_F(SplatLayerTest, AFileThatIsNotThereIsNamed) {
  task_.Change("block.ply", "none.ply");
  try {
    ReadTask(task_.path());
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("none.ply"), std::string::npos);
  }
}

}  // namespace
}  // namespace physpring
