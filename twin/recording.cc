// SPDX-License-Identifier: Apache-2.0
#include "twin/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <numeric>
#include <string_view>

#include "twin/atomic_file.h"
#include "twin/checks/clouds.h"
#include "twin/checks/lost_points.h"
#include "twin/checks/objects.h"
#include "twin/checks/outliers.h"
#include "twin/checks/plausibility.h"
#include "twin/checks/start_velocity.h"
#include "twin/column_names.h"
#include "twin/error.h"
#include "twin/grasps.h"
#include "twin/npz.h"
#include "twin/npz_fields.h"
#include "twin/quote.h"
#include "twin/recorded_rod.h"
#include "twin/recording_clocks.h"
#include "twin/unseen_points.h"

namespace physpring {
namespace {

constexpr double kStrongestGravity = 1000;  // m/s^2
constexpr std::array<std::string_view, 20> kArrays{
    "points",   "controllers",  "fps",        "mass",
    "gravity",  "ground",       "interior",   "rest",
    "velocity", "order",        "rod",        "surface",
    "track",    "train_frames", "timestamps", "controller_timestamps",
    "force",    "held",         "object",     "weight"};
constexpr double kSmallestDistance = 1e-7;            // m, between two particles
constexpr double kAssumedMass = 0.1;                  // kg
constexpr double kLeastMass = 1e-9, kMostMass = 1e6;  // kg

void ExpectKnownArrays(const Npz& arrays, const NpzFields& fields) {
  for (const auto& [name, array] : arrays) {
    if (std::find(kArrays.begin(), kArrays.end(), name) != kArrays.end()) continue;
    fields.Fail(fmt::format("array {} is not part of a recording, expected only {}", Quote(name),
                            fmt::join(kArrays, ", ")));
  }
}

std::vector<Points> ReadTracks(NpzFields& fields, const std::string& path, const std::string& name,
                               const std::string& size, Recording& recording) {
  std::vector<Points> frames = fields.FramesWithUnseen(name, size);
  const std::string lost = TakeZerosAsUnseen(fmt::format("{}: array '{}'", path, name), &frames);
  if (!lost.empty()) recording.warnings.push_back(lost);
  return frames;
}

// What counts nothing is not seen. The others count 1 on the average.
void ReadWeight(NpzFields& fields, Recording& recording) {
  recording.weight = fields.FramesOfNumbers("weight", "N", "T");
  if (recording.weight[0].rows() != 1) fields.Fail("weight", "has 3 dimensions, expected (T, N)");
  double sum = 0, seen = 0;
  for (std::size_t t = 0; t < recording.weight.size(); ++t) {
    for (Eigen::Index i = 0; i < recording.point_count(); ++i) {
      auto point = recording.points[t].col(i);
      double& weight = recording.weight[t](0, i);
      if (point.allFinite() && !(weight >= 0)) {
        fields.Fail("weight",
                    fmt::format("holds {} at [{}, {}], expected 0 or more", weight, t, i));
      }
      if (weight == 0) point.setConstant(std::numeric_limits<double>::quiet_NaN());
      if (!point.allFinite()) continue;
      sum += weight;
      ++seen;
    }
  }
  if (seen == 0) fields.Fail("weight", "is 0 for all that is seen");
  for (std::size_t t = 0; t < recording.weight.size(); ++t) {
    for (Eigen::Index i = 0; i < recording.point_count(); ++i) {
      double& weight = recording.weight[t](0, i);
      weight = recording.points[t].col(i).allFinite() ? weight * seen / sum : 1;
    }
  }
}

void ReadPoints(NpzFields& fields, const std::string& path, Recording& recording) {
  recording.points = ReadTracks(fields, path, "points", "N", recording);
  if (fields.Has("weight")) ReadWeight(fields, recording);
  if (fields.Extent("T") < 2) fields.Fail("points", "has fewer than 2 frames");
  if (!recording.points[0].array().isFinite().any()) {
    fields.Fail("points", "has nothing seen in frame 0, which a motion starts from");
  }
  for (Eigen::Index i = 0; i < recording.point_count(); ++i) {
    const auto sees = [i](const Points& frame) { return frame.col(i).allFinite(); };
    if (std::none_of(recording.points.begin(), recording.points.end(), sees)) {
      fields.Fail("points", fmt::format("has point {}, which is not seen in any frame", i));
    }
  }
}

// Whether nothing is said of points that are followed.
bool HasCloudsAlone(const NpzFields& fields) {
  constexpr std::array kOfPoints{"points", "interior", "rest",   "velocity",
                                 "order",  "rod",      "object", "weight"};
  return fields.Has("surface") && std::none_of(kOfPoints.begin(), kOfPoints.end(),
                                               [&](const char* name) { return fields.Has(name); });
}

std::vector<Points> ReadClouds(NpzFields& fields, const std::string& path, Recording& recording) {
  std::vector<Points> clouds = fields.FramesWithUnseen("surface", "S");
  const std::string none = TakeFillingAsNone(path + ": array 'surface'", &clouds);
  if (!none.empty()) recording.warnings.push_back(none);
  return clouds;
}

void ReadCloudsAlone(NpzFields& fields, const std::string& path, Recording& recording) {
  recording.surface = ReadClouds(fields, path, recording);
  if (fields.Extent("T") < 2) fields.Fail("surface", "has fewer than 2 frames");
  recording.points.assign(fields.Extent("T"), Points(3, 0));
}

// Sizes of forces are no less than 0.
void ExpectForceSizes(const NpzFields& fields, const std::vector<Eigen::MatrixXd>& force) {
  for (std::size_t t = 0; t < force.size(); ++t) {
    for (Eigen::Index c = 0; force[t].rows() == 1 && c < force[t].cols(); ++c) {
      if (!(force[t](0, c) < 0)) continue;
      fields.Fail("force", fmt::format("holds the size {:.4g} N at frame {}, controller {}, "
                                       "expected one of at least 0",
                                       force[t](0, c), t, c));
    }
  }
}

void ReadMeasured(NpzFields& fields, const std::string& path, Recording& recording) {
  const bool alone = HasCloudsAlone(fields);
  alone ? ReadCloudsAlone(fields, path, recording) : ReadPoints(fields, path, recording);
  const std::string times_of_controllers = fields.Has("controller_timestamps") ? "Tc" : "T";
  ReadControllers(fields, times_of_controllers, &recording);
  if (fields.Has("force")) {
    recording.force = fields.FramesOfNumbers("force", "C", times_of_controllers);
    ExpectForceSizes(fields, recording.force);
  }
  if (fields.Has("surface") && !alone) recording.surface = ReadClouds(fields, path, recording);
  if (fields.Has("track")) recording.track = ReadTracks(fields, path, "track", "K", recording);
}

double ReadBetween(NpzFields& fields, const std::string& name, double least, double most) {
  const double value = fields.Scalar(name);
  if (value < least || value > most) {
    fields.Fail(name, fmt::format("holds {}, expected {} to {}", value, least, most));
  }
  return value;
}

// a x + b y + c z = d, divided by |(a, b, c)|
Eigen::Vector4d ReadGround(NpzFields& fields) {
  const Eigen::Vector4d plane = fields.Vector("ground", "4");
  const double length = plane.head<3>().stableNorm();
  Eigen::Vector4d unit = plane / length;
  if (length > 0 && unit.allFinite()) return unit;
  fields.Fail("ground", fmt::format("holds the normal ({}, {}, {}), expected one that is not zero",
                                    plane[0], plane[1], plane[2]));
}

void ReadConstants(NpzFields& fields, const std::string& path, Recording& recording) {
  if (fields.Has("fps") || !fields.Has("timestamps")) {
    recording.fps = ReadBetween(fields, "fps", kLeastFps, kMostFps);
  }
  if (fields.Has("mass")) {
    recording.mass = ReadBetween(fields, "mass", kLeastMass, kMostMass);
  } else {
    recording.mass = kAssumedMass;
    recording.warnings.push_back(
        fmt::format("{}: no 'mass' is given, {} kg is assumed", path, kAssumedMass));
  }
  if (fields.Has("gravity")) recording.gravity = fields.Vector("gravity", "3");
  if (recording.gravity.cwiseAbs().maxCoeff() > kStrongestGravity) {
    fields.Fail("gravity", fmt::format("holds {:.3g} m/s^2, expected at most {}",
                                       recording.gravity.cwiseAbs().maxCoeff(), kStrongestGravity));
  }
  if (fields.Has("ground")) recording.ground = ReadGround(fields);

  const int frames = recording.frame_count();
  recording.train_frames = std::max(2, frames * 7 / 10);
  if (!fields.Has("train_frames")) return;
  recording.train_frames = fields.Ints("train_frames", {})[0];
  if (recording.train_frames < 2 || recording.train_frames > frames) {
    fields.Fail("train_frames", fmt::format("holds {}, expected 2 to {}, the number of frames",
                                            recording.train_frames, frames));
  }
}

void ReadParticles(NpzFields& fields, Recording& recording) {
  recording.interior.resize(3, 0);
  if (fields.Has("interior")) recording.interior = fields.Positions("interior", "M");
  const auto particles = static_cast<std::size_t>(recording.particle_count());
  fields.SetExtent("N+M", particles);
  fields.SetExtent("N+M+C", particles + fields.Extent("C"));

  recording.velocity = Points::Zero(3, recording.particle_count());
  if (fields.Has("velocity")) recording.velocity = fields.Positions("velocity", "N+M");
  if (fields.Has("object")) {
    const std::vector<int> declared = fields.Ints("object", {"N+M"});
    recording.object = Eigen::VectorXi::Map(declared.data(), std::ssize(declared));
  }
  recording.rest_given = fields.Has("rest");
  if (recording.rest_given) recording.rest = fields.Positions("rest", "N+M+C");
}

// Fails if two columns are closer than kSmallestDistance: the rest length between them would be
// zero. Only columns that are as close along the first coordinate are compared.
void ExpectDistinct(const NpzFields& fields, const Recording& recording, const std::string& array,
                    const Eigen::MatrixXd& positions) {
  std::vector<Eigen::Index> columns(static_cast<std::size_t>(positions.cols()));
  std::iota(columns.begin(), columns.end(), 0);
  std::sort(columns.begin(), columns.end(),
            [&](Eigen::Index a, Eigen::Index b) { return positions(0, a) < positions(0, b); });
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (std::size_t j = i + 1; j < columns.size(); ++j) {
      const auto difference = positions.col(columns[j]) - positions.col(columns[i]);
      if (difference[0] >= kSmallestDistance) break;
      if (difference.norm() >= kSmallestDistance) continue;
      const auto [first, second] = std::minmax(columns[i], columns[j]);
      const bool held = first < recording.particle_count() && second >= recording.particle_count();
      fields.Fail(array,
                  fmt::format("has {} and {} at the same place, expected {} m or more{}",
                              NameOfColumn(recording, first), NameOfColumn(recording, second),
                              kSmallestDistance,
                              held ? "; leave a point out that moves as its controller does" : ""));
    }
  }
}

std::string WarnOfPlaced(const std::string& path, int points, const std::vector<int>& placed) {
  constexpr std::size_t kShown = 5;
  const auto shown = static_cast<std::ptrdiff_t>(std::min(placed.size(), kShown));
  return fmt::format("{}: {} of {} points, not seen in frame 0, placed from neighbours: {}{}", path,
                     placed.size(), points, fmt::join(placed.begin(), placed.begin() + shown, ", "),
                     placed.size() > kShown ? ", ..." : "");
}

void SetStart(NpzFields& fields, const std::string& path, Recording& recording) {
  recording.start.resize(3, recording.particle_count() + recording.controller_count());
  recording.start << recording.points[0], recording.interior, recording.controllers[0];
  const std::vector<int> placed = PlaceUnseenPoints(recording);
  if (!placed.empty())
    recording.warnings.push_back(WarnOfPlaced(path, recording.point_count(), placed));

  ExpectDistinct(fields, recording, "points", recording.start);
  if (recording.rest_given) ExpectDistinct(fields, recording, "rest", recording.rest);
  if (!recording.rest_given) recording.rest = recording.start;
  ReadRod(fields, &recording);
  if (fields.Has("order")) {
    ExpectDistinct(fields, recording, "order", recording.rod.arc.transpose());
  }
}

void SetVelocity(const std::string& path, Recording& recording) {
  const std::optional<StartVelocity> start = EstimateStartVelocity(recording);
  if (!start) return;
  if (!start->measured) {
    recording.notes.push_back(path +
                              ": starts in motion, but most of it is too far from the points to "
                              "know how it moves: rest is assumed; give 'velocity' if it is known");
    return;
  }
  recording.velocity = start->velocity;
  recording.notes.push_back(path +
                            ": starts in motion: velocities are taken from the first frames");
}

// Objects as declared, or else as found.
void TellObjects(const std::string& path, Recording& recording) {
  if (recording.object.size() > 0) {
    recording.object = DeclaredObjects(recording, recording.object);
    return;
  }
  recording.object = FindObjects(recording);
  if (recording.object.size() == 0) return;
  recording.warnings.push_back(
      fmt::format("{}: shows {} objects that part: no spring joins them; the array 'object' "
                  "declares them",
                  path, ObjectCount(recording)));
}

void AddWarnings(const std::string& path, const std::vector<std::string>& oddities,
                 Recording* recording) {
  for (const std::string& oddity : oddities) {
    recording->warnings.push_back(fmt::format("{}: {}", path, oddity));
  }
}

// Works out what is not given, and says what is odd.
void Check(const std::string& path, bool velocity_given, Recording& recording) {
  TellObjects(path, recording);
  CutRodBetweenObjects(&recording);
  if (!velocity_given) SetVelocity(path, recording);
  AddWarnings(path, FindOddities(recording), &recording);
}

// All that the arrays say.
Recording ReadArrays(const Npz& arrays, const std::string& path) {
  NpzFields fields(arrays, path);
  if (arrays.contains("meta") && !arrays.contains("points"))
    fields.Fail("is a twin, not a recording");
  ExpectKnownArrays(arrays, fields);
  Recording recording;
  recording.name = std::filesystem::path(path).stem().string();
  ReadMeasured(fields, path, recording);
  ReadConstants(fields, path, recording);
  BringToOneRate(fields, path, &recording);
  ReadParticles(fields, recording);
  SetStart(fields, path, recording);
  if (recording.point_count() > 0) {  // before any is taken for where a hand takes hold
    const std::string left_out = LeaveOutOutliers(path, &recording);
    if (!left_out.empty()) recording.warnings.push_back(left_out);
  }
  SplitGrasps(fields, &recording);
  return recording;
}

}  // namespace

// Of a large file no more is held than is needed: the arrays go before the checks, and in
// ReadRecording the bytes before both.
Recording ParseRecording(Npz arrays, const std::string& path) {
  Recording recording = ReadArrays(arrays, path);
  if (recording.point_count() == 0) {
    AddWarnings(path, FindOddClouds(recording), &recording);
    return recording;
  }
  const bool velocity_given = arrays.contains("velocity");
  arrays.clear();
  Check(path, velocity_given, recording);
  return recording;
}

Recording ReadRecordingOrClouds(const std::string& path) {
  std::string bytes = ReadFile(path);
  const std::string hash = HashBytes(bytes);
  Npz arrays = ParseNpz(bytes, path);
  bytes = std::string();
  Recording recording = ParseRecording(std::move(arrays), path);
  recording.hash = hash;
  return recording;
}

Recording ReadRecording(const std::string& path) {
  Recording recording = ReadRecordingOrClouds(path);
  ExpectPoints(recording, path);
  return recording;
}

void ExpectPoints(const Recording& recording, const std::string& path) {
  if (recording.point_count() > 0) return;
  throw Error(
      path + ": has clouds ('surface') and no 'points'; `physpring register` makes points of them");
}

}  // namespace physpring
