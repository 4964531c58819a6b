// SPDX-License-Identifier: Apache-2.0
#include "splats/fit/surface_start.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "twin/error.h"

namespace physpring {
namespace {

using Eigen::Vector3d;

// What a pixel shows of the surface.
struct SurfacePoint {
  Vector3d position, normal, colour;
};

// The points of the object in one picture.
class DepthView {
 public:
  DepthView(const PictureFolder& pictures, int camera, int frame)
      : view_(pictures.cameras()[camera].view),
        image_(pictures.ReadImage(camera, frame)),
        mask_(pictures.ReadObjectMask(camera, frame)),
        depth_(pictures.ReadDepthImage(camera, frame)) {}

  void AddPoints(std::vector<SurfacePoint>* points) const {
    constexpr double kByte = 255;
    for (int y = 0; y < view_.height; ++y) {
      for (int x = 0; x < view_.width; ++x) {
        const std::optional<Vector3d> position = At(x, y);
        if (!position) continue;
        const unsigned char* rgb = &image_.rgb[3 * Place(x, y)];
        points->push_back(
            {*position, NormalAt(x, y, *position), Vector3d(rgb[0], rgb[1], rgb[2]) / kByte});
      }
    }
  }

 private:
  std::size_t Place(int x, int y) const { return static_cast<std::size_t>(y) * view_.width + x; }

  // In the world; none where it is not the object, or its depth is not known.
  std::optional<Vector3d> At(int x, int y) const {
    if (x < 0 || y < 0 || x >= view_.width || y >= view_.height) return {};
    const double z = depth_.metres[Place(x, y)];
    if (mask_.kind[Place(x, y)] != kObject || !(z > 0)) return {};
    const Vector3d t(z * (x + 0.5 - view_.cx) / view_.fx, z * (y + 0.5 - view_.cy) / view_.fy, z);
    return view_.axes.transpose() * (t - view_.shift);
  }

  // Towards the camera; where the neighbours do not tell, at the camera.
  Vector3d NormalAt(int x, int y, const Vector3d& position) const {
    const Vector3d to_camera = (view_.centre() - position).normalized();
    const std::optional<Vector3d> left = At(x - 1, y), right = At(x + 1, y);
    const std::optional<Vector3d> above = At(x, y - 1), below = At(x, y + 1);
    if (!left || !right || !above || !below) return to_camera;
    const Vector3d normal = (*right - *left).cross(*above - *below);
    const double cosine = normal.normalized().dot(to_camera);
    constexpr double kLeast = 0.1;  // steeper: an edge between near and far
    return cosine > kLeast ? normal.normalized() : to_camera;
  }

  const PinholeCamera& view_;
  const Image image_;
  const Mask mask_;
  const DepthImage depth_;
};

using Cell = std::array<std::int64_t, 3>;

Cell CellOf(const Vector3d& position, double size) {
  const Eigen::Array3d cell = (position.array() / size).floor();
  return {static_cast<std::int64_t>(cell[0]), static_cast<std::int64_t>(cell[1]),
          static_cast<std::int64_t>(cell[2])};
}

std::size_t CellCount(const std::vector<SurfacePoint>& points, double size) {
  std::vector<Cell> cells;
  cells.reserve(points.size());
  for (const SurfacePoint& point : points) cells.push_back(CellOf(point.position, size));
  std::sort(cells.begin(), cells.end());
  return static_cast<std::size_t>(std::unique(cells.begin(), cells.end()) - cells.begin());
}

// The size of cells of which the points are in about `count`, m.
double SizeFor(const std::vector<SurfacePoint>& points, int count) {
  double small = 1e-5, large = 10;
  constexpr int kHalvings = 30;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = std::sqrt(small * large);
    (CellCount(points, middle) > static_cast<std::size_t>(count) ? small : large) = middle;
  }
  return large;
}

std::vector<SurfacePoint> MeanOfEachCell(const std::vector<SurfacePoint>& points, double size) {
  struct Sum {
    SurfacePoint sum{Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
    int count = 0;
  };
  std::map<Cell, Sum> cells;
  for (const SurfacePoint& point : points) {
    Sum& cell = cells[CellOf(point.position, size)];
    cell.sum.position += point.position;
    cell.sum.normal += point.normal;
    cell.sum.colour += point.colour;
    ++cell.count;
  }
  std::vector<SurfacePoint> means;
  for (const auto& [place, cell] : cells) {
    means.push_back(
        {cell.sum.position / cell.count, cell.sum.normal, cell.sum.colour / cell.count});
  }
  return means;
}

FreeSplat FlatSplat(const SurfacePoint& point, double spacing) {
  constexpr double kAlong = 0.6, kAcross = 0.2;  // deviations, in spacings
  constexpr double kOpacity = 0.9;
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), point.normal);
  FreeSplat splat;
  splat << point.position, std::log(kAlong * spacing), std::log(kAlong * spacing),
      std::log(kAcross * spacing), turn.w(), turn.x(), turn.y(), turn.z(),
      std::log(kOpacity / (1 - kOpacity)), point.colour;
  return splat;
}

}  // namespace

SurfaceStart StartOnSurface(const PictureFolder& pictures, const std::vector<int>& cameras,
                            int frame, int count) {
  if (!pictures.has_depth()) {
    throw Error(pictures.path() +
                ": has no depth (cameras.json names no depth_unit); splats begin "
                "on the surface that depth shows");
  }
  std::vector<SurfacePoint> points;
  for (const int camera : cameras) DepthView(pictures, camera, frame).AddPoints(&points);
  if (points.empty()) {
    throw Error(fmt::format("{}: no camera sees the object, or how far it is, in frame {}",
                            pictures.path(), frame));
  }
  // several pixels in most cells: where they are fewer, the cells' size says nothing
  constexpr double kMostOfPoints = 0.7;
  const int most = static_cast<int>(kMostOfPoints * static_cast<double>(points.size()));
  SurfaceStart start;
  start.spacing = SizeFor(points, std::clamp(count, 1, std::max(1, most)));
  const std::vector<SurfacePoint> means = MeanOfEachCell(points, start.spacing);
  start.splats.resize(Eigen::NoChange, static_cast<Eigen::Index>(means.size()));
  for (std::size_t i = 0; i < means.size(); ++i) {
    start.splats.col(static_cast<Eigen::Index>(i)) = FlatSplat(means[i], start.spacing);
  }
  return start;
}

}  // namespace physpring
