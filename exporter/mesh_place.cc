// SPDX-License-Identifier: Apache-2.0
#include "exporter/mesh_place.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <limits>
#include <optional>

#include "exporter/mesh_distance.h"
#include "exporter/mesh_file.h"
#include "exporter/surface.h"
#include "twin/error.h"

namespace physpring {
namespace {

constexpr double kDistanceOfSize = 0.03, kDistanceOfSpacing = 0.5;
// A mesh in other units may touch the points with a corner.
constexpr double kMostTimesLarger = 10;
// The other way up is better if it halves the distance, unless both are this near, in parts of what
// fits.
constexpr double kNear = 1 / 3.0;
// Fewer points say too little about axes and units.
constexpr int kFewPoints = 4;
constexpr int kMostPoints = 500;  // that are compared
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Eigen::Vector3d SidesOfBox(const Points& points) {
  return points.rowwise().maxCoeff() - points.rowwise().minCoeff();
}

Points EveryNth(const Points& points) {
  const Eigen::Index step = (points.cols() + kMostPoints - 1) / kMostPoints;
  return points(Eigen::all, Eigen::seq(0, Eigen::last, step));
}

// Without those that have others all around them, as the inner ones of a lattice: no surface is
// near them.
Points OuterPoints(const Points& points, double spacing) {
  if (points.cols() < kFewPoints || spacing <= 0 || IsSheet(points)) return points;
  const NeighbourSearch surface(ClosedSurface(points, spacing / 2).vertices);
  std::vector<Eigen::Index> outer;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    if (surface.Nearest(points.col(i), 1)[0].distance < 0.8 * spacing) outer.push_back(i);
  }
  return points(Eigen::all, outer);
}

// What the points say about a mesh.
struct Measured {
  Points points;         // those that are compared
  Eigen::Vector3d size;  // m, of the box of all
  double spacing;        // m
  double tolerance;      // m: the mean distance of a mesh that fits
  double largest_scale;  // m per unit: with a larger one the mesh is far larger than the points
};

Measured Measure(const Points& points, const TriangleMesh& mesh) {
  Measured measured{points, SidesOfBox(points), 0, 0, 1};
  if (points.cols() > 1) measured.spacing = Spacing(points);
  const bool few = points.cols() < kFewPoints;
  const double mesh_size = SidesOfBox(mesh.vertices).norm();
  const double size = few ? mesh_size : measured.size.norm();
  if (!few) measured.largest_scale = kMostTimesLarger * size / mesh_size;
  measured.tolerance = std::max(kDistanceOfSize * size, kDistanceOfSpacing * measured.spacing);
  measured.points = EveryNth(points);
  return measured;
}

// How the coordinates of a file become metres, z up.
struct Reading {
  bool turned;   // y up in the file
  double scale;  // m per unit
};

struct Fit {
  Reading reading;
  double distance;  // m, mean of the points
};

Eigen::Matrix3d Turn(const Reading& reading) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  if (reading.turned) turn << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  return turn;
}

// In the coordinates of the file, so that one search serves all readings. Where the mean distance
// is more than `enough`, another one that is more may come out.
Fit FitOf(const Reading& reading, const MeshDistance& mesh, const Points& points, double enough) {
  const Points in_file = Turn(reading).transpose() * points / reading.scale;
  const double at_least = reading.scale * mesh.MeanToBox(in_file);
  return {reading, at_least > enough ? at_least : reading.scale * mesh.Mean(in_file)};
}

// glTF: "the up axis is +Y" (glTF 2.0, section 3.4). Assimp turns Collada to y up, too.
bool IsYUp(const std::string& path) {
  std::string type = std::filesystem::path(path).extension().string();
  std::transform(type.begin(), type.end(), type.begin(),
                 [](unsigned char letter) { return std::tolower(letter); });
  return type == ".glb" || type == ".gltf" || type == ".dae";
}

// The reading by the rule, or the other way up where that is clearly better.
Fit BetterWayUp(bool y_up, double scale, const MeshDistance& mesh, const Measured& measured) {
  const double enough = 2 * measured.tolerance;
  const Fit rule = FitOf({y_up, scale}, mesh, measured.points, enough);
  if (rule.distance < kNear * measured.tolerance) return rule;
  const Fit other = FitOf({!y_up, scale}, mesh, measured.points, enough);
  return other.distance < std::min(measured.tolerance, rule.distance / 2) ? other : rule;
}

std::optional<Fit> FindFit(bool y_up, const MeshDistance& mesh, const Measured& measured) {
  for (const double scale : {1.0, 0.01, 0.001}) {
    const Fit fit = BetterWayUp(y_up, scale, mesh, measured);
    if (fit.distance < measured.tolerance && scale < measured.largest_scale) return fit;
  }
  return std::nullopt;
}

std::string FormatBox(const Points& points) {
  const Eigen::Vector3d size = SidesOfBox(points);
  const Eigen::Vector3d middle = points.rowwise().minCoeff() + size / 2;
  return fmt::format("{:.3g} m around ({:.3g})", fmt::join(size, " x "), fmt::join(middle, ", "));
}

Points InMetres(const Points& vertices, const Reading& reading) {
  return reading.scale * (Turn(reading) * vertices);
}

std::string Mismatch(const Fit& fit, const Measured& measured) {
  if (fit.distance < measured.tolerance) {
    return fmt::format("is {:.2g} times as large as the measured points, expected less than {}",
                       kMostTimesLarger / measured.largest_scale, kMostTimesLarger);
  }
  return fmt::format(
      "the measured points are {:.2g} m from the mesh on average, expected less than {:.2g} m "
      "(their spacing is {:.2g} m)",
      fit.distance, measured.tolerance, measured.spacing);
}

[[noreturn]] void Refuse(const std::string& path, const TriangleMesh& mesh, const Fit& fit,
                         const Measured& measured, const Points& points) {
  throw Error(fmt::format(
      "{}: {}; is the mesh in another frame or unit? the mesh measures {}, the points {}", path,
      Mismatch(fit, measured), FormatBox(InMetres(mesh.vertices, fit.reading)), FormatBox(points)));
}

std::vector<std::string> Guesses(const std::string& path, bool y_up, const Fit& fit) {
  std::vector<std::string> warnings;
  if (fit.reading.scale != 1) {
    warnings.push_back(fmt::format(
        "{}: taken as {}, because then the measured points are {:.2g} m from the mesh on average",
        path, fit.reading.scale == 0.01 ? "centimetres" : "millimetres", fit.distance));
  }
  if (fit.reading.turned != y_up) {
    warnings.push_back(fmt::format(
        "{}: taken as {}, because then the measured points are {:.2g} m from the mesh on average",
        path, y_up ? "z up, against the rule of its format" : "y up, and turned to z up",
        fit.distance));
  }
  return warnings;
}

}  // namespace

PlacedMesh ReadMeshAt(const std::string& path, const Points& points) {
  TriangleMesh mesh = ReadMesh(path);
  const bool y_up = IsYUp(path);
  Measured measured = Measure(points, mesh);
  const MeshDistance distance(mesh);
  const Fit rule = FitOf({y_up, 1}, distance, measured.points, kInfinity);
  std::optional<Fit> fit = rule;
  if (points.cols() >= kFewPoints) {
    fit = FindFit(y_up, distance, measured);
    if (!fit) {
      measured.points = EveryNth(OuterPoints(points, measured.spacing));
      fit = FindFit(y_up, distance, measured);
    }
  } else if (rule.distance >= measured.tolerance) {
    fit.reset();
  }
  if (!fit) Refuse(path, mesh, rule, measured, points);
  mesh.vertices = InMetres(mesh.vertices, fit->reading);
  return {mesh, Guesses(path, y_up, *fit)};
}

}  // namespace physpring
