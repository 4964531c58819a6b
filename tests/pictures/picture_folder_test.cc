// SPDX-License-Identifier: Apache-2.0
#include "pictures/picture_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <filesystem>

#include "tests/support/temporary_folder.h"
#include "twin/atomic_file.h"
#include "twin/error.h"

namespace physpring {
namespace {

using ::testing::HasSubstr;

RecordedCamera SomeCamera(const std::string& name) {
  RecordedCamera camera{name, {6, 4}};
  camera.view.axes = Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, -0.4, 0.2).normalized()).matrix();
  camera.view.shift = {0.1, -0.2, 0.9};
  camera.view.fx = 7.5;
  camera.view.fy = 7.25;
  camera.view.cx = 3.125;
  camera.view.cy = 1.75;
  return camera;
}

TEST(PictureFolder, ComesBackAsWritten) {
  const TemporaryFolder folder;
  const PictureFolder written(folder.path(), 29.97, 3, 1e-4,
                              {SomeCamera("front"), SomeCamera("side_2")});
  written.MakeFolders();
  const Image image{6, 4, std::vector<unsigned char>(72, 40)};
  const Mask mask{6, 4, std::vector<unsigned char>(24, kObject)};
  const DepthImage depth{6, 4, std::vector<float>(24, 0.75F)};
  written.Write(1, 2, image);
  written.Write(1, 2, mask);
  written.Write(1, 2, depth);
  written.WriteCameras();

  const PictureFolder found(folder.path());
  EXPECT_EQ(found.fps(), 29.97);
  EXPECT_EQ(found.frame_count(), 3);
  ASSERT_EQ(found.cameras().size(), 2U);
  EXPECT_EQ(found.CameraOf("side_2"), 1);
  const PinholeCamera& view = found.cameras()[1].view;
  EXPECT_TRUE(view.axes.isApprox(SomeCamera("").view.axes, 1e-14));
  EXPECT_TRUE(view.shift.isApprox(SomeCamera("").view.shift, 1e-14));
  EXPECT_EQ(view.cx, 3.125);
  EXPECT_EQ(found.ReadImage(1, 2).rgb, image.rgb);
  EXPECT_EQ(found.ReadObjectMask(1, 2).kind, mask.kind);
  EXPECT_NEAR(found.ReadDepthImage(1, 2).metres[5], 0.75, 1e-6);
  EXPECT_THROW(found.ReadImage(0, 2), Error);
}

TEST(PictureFolder, IsNoneUntilAllIsWritten) {
  const TemporaryFolder folder;
  const PictureFolder written(folder.path(), 30, 1, 0, {SomeCamera("front")});
  written.MakeFolders();
  EXPECT_THROW(PictureFolder{folder.path()}, Error);
  written.WriteCameras();
  EXPECT_FALSE(PictureFolder(folder.path()).has_depth());
  EXPECT_THROW(written.MakeFolders(), Error);  // another recording would be lost
}

TEST(PictureFolder, CamerasHaveNamesThatFoldersCanHave) {
  for (const char* name : {"..", "a/b", "front left", ""}) {
    EXPECT_THROW(PictureFolder("x", 30, 1, 0, {SomeCamera(name)}), Error) << name;
  }
  EXPECT_THROW(PictureFolder("x", 30, 1, 0, {SomeCamera("a"), SomeCamera("a")}), Error);
}

TEST(PictureFolder, RemovesWhatItHasWrittenAlone) {
  const TemporaryFolder folder;
  const PictureFolder written(folder.File("seen"), 30, 2, 1e-4, {SomeCamera("front")});
  written.MakeFolders();
  written.Write(0, 0, Mask{6, 4, std::vector<unsigned char>(24, kObject)});
  WriteFileAtomically(folder.File("seen/mask/notes.txt"), "mine");
  written.Remove(2);
  EXPECT_FALSE(std::filesystem::exists(folder.File("seen/color")));
  EXPECT_FALSE(std::filesystem::exists(folder.File("seen/mask/front")));
  EXPECT_TRUE(std::filesystem::exists(folder.File("seen/mask/notes.txt")));
}

struct BadFile {
  const char *from, *to, *message;
};

class BadCameras : public ::testing::TestWithParam<BadFile> {};

TEST_P(BadCameras, AreRefusedInALine) {
  const TemporaryFolder folder;
  std::string text = R"({"format": "physpring pictures", "version": 1, "fps": 30, "frames": 2,
    "cameras": [{"name": "front", "width": 6, "height": 4, "fx": 7, "fy": 7, "cx": 3, "cy": 2,
      "pose": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}]})";
  const std::size_t at = text.find(GetParam().from);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, std::string(GetParam().from).size(), GetParam().to);
  WriteFileAtomically(folder.File("cameras.json"), text);
  try {
    const PictureFolder found(folder.path());
    FAIL() << "nothing is refused";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr(folder.File("cameras.json")));
    EXPECT_THAT(error.what(), HasSubstr(GetParam().message));
  }
}
INSTANTIATE_TEST_SUITE_P(
    Of, BadCameras,
    ::testing::Values(BadFile{"physpring pictures", "other", "must be 'physpring pictures'"},
                      BadFile{"\"version\": 1", "\"version\": 2", "holds 2, expected 1 to 1"},
                      BadFile{"\"fps\": 30", "\"fps\": 0", "holds 0, expected 0.1 to"},
                      BadFile{"\"frames\": 2", "\"frames\": 0", "expected 1 to"},
                      BadFile{"\"width\": 6", "\"width\": 100000", "expected 1 to 8192"},
                      BadFile{"front", "../front", "must be letters, digits"},
                      BadFile{"[1, 0", "[2, 0", "is no rotation and shift"},
                      BadFile{", 0, 1]", "]", "has 14 numbers; must be a 4 x 4 matrix"},
                      BadFile{"\"fx\": 7, ", "", "fx"},
                      BadFile{"\"fx\": 7", "\"fx\": 1e300", "holds 1e+300, expected"},
                      BadFile{"[1, 0, 0, 0,", "[1, 0, 0, 1e300,", "is farther than 1000 m"},
                      BadFile{"\"cx\"", "\"c_x\"", "c_x"}));

}  // namespace
}  // namespace physpring
