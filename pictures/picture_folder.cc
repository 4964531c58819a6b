// SPDX-License-Identifier: Apache-2.0
#include "pictures/picture_folder.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "pictures/png_file.h"
#include "twin/atomic_file.h"
#include "twin/bounded_fields.h"
#include "twin/error.h"
#include "twin/json_fields.h"
#include "twin/plain_name.h"
#include "twin/quote.h"
#include "twin/recording_clocks.h"

namespace physpring {
namespace {

namespace fs = std::filesystem;

constexpr char kFile[] = "cameras.json", kFormat[] = "physpring pictures";
constexpr int kVersion = 1, kMostPixels = 8192, kMostFrames = 1000000;
constexpr double kLeastFocal = 1e-3, kFarthestPixel = 1e6;  // pixels
constexpr double kFarthest = 1000;                          // m
constexpr double kLeastUnit = 1e-6, kMostUnit = 0.01;       // m, of depths

// A name becomes a folder.
std::string NameIn(const JsonFields& json) {
  const std::string name = json.Text("name");
  if (!IsPlainName(name)) {
    json.Fail("name", fmt::format("is {}; must be {}", Quote(name), kPlainName));
  }
  return name;
}

void ReadPose(const JsonFields& json, PinholeCamera* view) {
  const std::vector<double> numbers = json.Numbers("pose");
  if (numbers.size() != 16) {
    json.Fail("pose", fmt::format("has {} numbers; must be a 4 x 4 matrix", numbers.size()));
  }
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> pose(numbers.data());
  const Eigen::Matrix3d turn = pose.topLeftCorner<3, 3>();
  constexpr double kTolerance = 1e-4;
  const bool rigid = (turn.transpose() * turn).isIdentity(kTolerance) && turn.determinant() > 0 &&
                     pose.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1));
  if (!rigid) json.Fail("pose", "is no rotation and shift from the camera to the world");
  if (!(pose.topRightCorner<3, 1>().cwiseAbs().maxCoeff() <= kFarthest)) {
    json.Fail("pose", fmt::format("is farther than {} m from the origin", kFarthest));
  }
  view->axes = turn.transpose();
  view->shift = -turn.transpose() * pose.topRightCorner<3, 1>();
}

RecordedCamera ReadCamera(const JsonFields& json) {
  json.ExpectOnly({"name", "width", "height", "fx", "fy", "cx", "cy", "pose"});
  RecordedCamera camera{NameIn(json), {}};
  camera.view.width = CountBetween(json, "width", 1, kMostPixels);
  camera.view.height = CountBetween(json, "height", 1, kMostPixels);
  camera.view.fx = NumberBetween(json, "fx", kLeastFocal, kFarthestPixel);
  camera.view.fy = NumberBetween(json, "fy", kLeastFocal, kFarthestPixel);
  camera.view.cx = NumberBetween(json, "cx", -kFarthestPixel, kFarthestPixel);
  camera.view.cy = NumberBetween(json, "cy", -kFarthestPixel, kFarthestPixel);
  ReadPose(json, &camera.view);
  return camera;
}

nlohmann::ordered_json JsonOf(const RecordedCamera& camera) {
  const PinholeCamera& view = camera.view;
  Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
  pose.topLeftCorner<3, 3>() = view.axes.transpose();
  pose.topRightCorner<3, 1>() = view.centre();
  const Eigen::Matrix4d by_rows = pose.transpose();
  return {{"name", camera.name},
          {"width", view.width},
          {"height", view.height},
          {"fx", view.fx},
          {"fy", view.fy},
          {"cx", view.cx},
          {"cy", view.cy},
          {"pose", std::vector<double>(by_rows.data(), by_rows.data() + by_rows.size())}};
}

}  // namespace

PictureFolder::PictureFolder(const std::string& path) : path_(path) {
  const JsonFields json = ReadJsonFile((fs::path(path) / kFile).string());
  json.ExpectOnly({"format", "version", "fps", "frames", "depth_unit", "cameras"});
  if (json.Text("format") != kFormat) {
    json.Fail("format", fmt::format("must be {}", Quote(kFormat)));
  }
  CountBetween(json, "version", kVersion, kVersion);
  fps_ = NumberBetween(json, "fps", kLeastFps, kMostFps);
  frames_ = CountBetween(json, "frames", 1, kMostFrames);
  if (json.Has("depth_unit")) {
    depth_unit_ = NumberBetween(json, "depth_unit", kLeastUnit, kMostUnit);
  }
  for (const JsonFields& camera : json.Objects("cameras")) {
    cameras_.push_back(ReadCamera(camera));
    const auto is_same = [&](const RecordedCamera& other) {
      return other.name == cameras_.back().name;
    };
    if (std::any_of(cameras_.begin(), cameras_.end() - 1, is_same)) {
      camera.Fail("name", fmt::format("is {} twice", Quote(cameras_.back().name)));
    }
  }
  if (cameras_.empty()) json.Fail("cameras", "is empty");
}

PictureFolder::PictureFolder(std::string path, double fps, int frames, double depth_unit,
                             std::vector<RecordedCamera> cameras)
    : path_(std::move(path)),
      fps_(fps),
      frames_(frames),
      depth_unit_(depth_unit),
      cameras_(std::move(cameras)) {
  std::set<std::string> names;
  for (const RecordedCamera& camera : cameras_) {
    if (!IsPlainName(camera.name)) {
      throw Error(fmt::format("camera {} cannot have a folder of pictures; its name must be {}",
                              Quote(camera.name), kPlainName));
    }
    if (!names.insert(camera.name).second) {
      throw Error(fmt::format("camera {} is named twice", Quote(camera.name)));
    }
  }
}

void PictureFolder::MakeFolders() const {
  std::error_code none;
  if (fs::exists(fs::path(path_) / kFile, none)) {
    throw Error(path_ + ": has pictures already; name another folder, or remove it");
  }
  for (const RecordedCamera& camera : cameras_) {
    MakeFolder(FolderOf("color", camera.name));
    MakeFolder(FolderOf("mask", camera.name));
    if (has_depth()) MakeFolder(FolderOf("depth", camera.name));
  }
}

void PictureFolder::Remove(int frames) const {
  std::error_code ignored;
  for (const char* kind : {"color", "mask", "depth"}) {
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
      for (int frame = 0; frame < frames; ++frame) {
        fs::remove(PathOf(kind, static_cast<int>(i), frame), ignored);
      }
      fs::remove(FolderOf(kind, cameras_[i].name), ignored);
    }
    fs::remove(fs::path(path_) / kind, ignored);
  }
  fs::remove(path_, ignored);
}

void PictureFolder::WriteCameras() const {
  nlohmann::ordered_json json{
      {"format", kFormat}, {"version", kVersion}, {"fps", fps_}, {"frames", frames_}};
  if (has_depth()) json["depth_unit"] = depth_unit_;
  for (const RecordedCamera& camera : cameras_) json["cameras"].push_back(JsonOf(camera));
  WriteFileAtomically((fs::path(path_) / kFile).string(), json.dump(1) + "\n");
}

int PictureFolder::CameraOf(const std::string& name) const {
  std::string names;
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    if (cameras_[i].name == name) return static_cast<int>(i);
    names += (i == 0 ? "" : ", ") + cameras_[i].name;
  }
  throw Error(fmt::format("{}: has no camera {}; it has {}", (fs::path(path_) / kFile).string(),
                          Quote(name), names));
}

std::string PictureFolder::FolderOf(const char* kind, const std::string& camera) const {
  return (fs::path(path_) / kind / camera).string();
}

std::string PictureFolder::PathOf(const char* kind, int camera, int frame) const {
  return fmt::format("{}/{:05}.png", FolderOf(kind, cameras_[camera].name), frame);
}

Image PictureFolder::ReadImage(int camera, int frame) const {
  const PinholeCamera& view = cameras_[camera].view;
  return ReadColours(PathOf("color", camera, frame), view.width, view.height);
}

Mask PictureFolder::ReadObjectMask(int camera, int frame) const {
  const PinholeCamera& view = cameras_[camera].view;
  return ReadMask(PathOf("mask", camera, frame), view.width, view.height);
}

DepthImage PictureFolder::ReadDepthImage(int camera, int frame) const {
  const PinholeCamera& view = cameras_[camera].view;
  return ReadDepth(PathOf("depth", camera, frame), view.width, view.height, depth_unit_);
}

void PictureFolder::Write(int camera, int frame, const Image& image) const {
  WritePng(image, PathOf("color", camera, frame));
}

void PictureFolder::Write(int camera, int frame, const Mask& mask) const {
  WritePng(mask, PathOf("mask", camera, frame));
}

void PictureFolder::Write(int camera, int frame, const DepthImage& depth) const {
  WritePng(depth, depth_unit_, PathOf("depth", camera, frame));
}

}  // namespace physpring
