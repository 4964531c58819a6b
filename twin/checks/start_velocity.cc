// SPDX-License-Identifier: Apache-2.0
#include "twin/checks/start_velocity.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <vector>

#include "twin/checks/motion_scale.h"
#include "twin/neighbours.h"

namespace physpring {
namespace {

constexpr int kFewestParabolaFrames = 3, kMostParabolaFrames = 40;
constexpr double kLongest = 0.2;       // s, the longest time that a parabola is laid through
constexpr double kFits = 1.3;          // its residuals are no more than so many times the noise
constexpr double kInMotion = 0.6;      // v makes so much of the second step
constexpr double kSignificant = 2;     // and is so many times its standard error
constexpr double kSame = 0.5;          // of v there is over half the time
constexpr double kRounding = 1e-6;     // of the object's size: a smaller step is none
constexpr double kFarInterior = 0.25;  // of the object's size
constexpr int kMoveAlike = 4;

// Parabolas through the first frames of points that are seen in all of them.
struct Parabolas {
  Eigen::RowVectorXd weights;  // (frames) v = sum of weight x position
  double square = 0;           // the sum of squared residuals, m^2
  double freedoms = 0;

  double Residual() const { return freedoms > 0 ? std::sqrt(square / freedoms) : 0; }
};

bool SeenInAll(const std::vector<Points>& points, int frames, Eigen::Index i) {
  return std::all_of(points.begin(), points.begin() + frames,
                     [i](const Points& frame) { return frame.col(i).allFinite(); });
}

Eigen::MatrixX3d PathOf(const std::vector<Points>& points, int frames, Eigen::Index i) {
  Eigen::MatrixX3d path(frames, 3);
  for (int t = 0; t < frames; ++t) path.row(t) = points[t].col(i).transpose();
  return path;
}

Parabolas LayParabolas(const Recording& recording, int frames) {
  const Eigen::ArrayXd time = Eigen::ArrayXd::LinSpaced(frames, 0, frames - 1) / recording.fps;
  Eigen::MatrixX3d powers(frames, 3);
  powers << Eigen::VectorXd::Ones(frames), time, time.square();
  const Eigen::MatrixXd inverse = powers.completeOrthogonalDecomposition().pseudoInverse();
  Parabolas parabolas;
  parabolas.weights = inverse.row(1);
  for (Eigen::Index i = 0; i < recording.point_count(); ++i) {
    if (!SeenInAll(recording.points, frames, i)) continue;
    const Eigen::MatrixX3d path = PathOf(recording.points, frames, i);
    parabolas.square += (path - powers * (inverse * path)).squaredNorm();
    parabolas.freedoms += 3.0 * (frames - 3);
  }
  return parabolas;
}

// The most frames that parabolas fit.
Parabolas LongestParabolas(const Recording& recording, double noise) {
  const int most = std::clamp(static_cast<int>(kLongest * recording.fps) + 1, kFewestParabolaFrames,
                              std::min(kMostParabolaFrames, recording.train_frames));
  Parabolas longest = LayParabolas(recording, kFewestParabolaFrames);
  for (int frames = kFewestParabolaFrames + 1; frames <= most; ++frames) {
    const Parabolas longer = LayParabolas(recording, frames);
    if (longer.freedoms == 0 || longer.Residual() > kFits * noise) break;
    longest = longer;
  }
  return longest;
}

Eigen::Vector3d VelocityOf(const std::vector<Points>& points, const Eigen::RowVectorXd& weights,
                           Eigen::Index i) {
  return (weights * PathOf(points, static_cast<int>(weights.size()), i)).transpose();
}

// Velocities of some columns of the start, and where these are.
struct Known {
  std::vector<Eigen::Index> columns;
  Points place, velocity;
};

Known KnownVelocities(const Recording& recording, const Eigen::RowVectorXd& weights) {
  const int frames = static_cast<int>(weights.size());
  Known known;
  std::vector<Eigen::Vector3d> velocities;
  for (Eigen::Index i = 0; i < recording.point_count(); ++i) {
    if (!SeenInAll(recording.points, frames, i)) continue;
    known.columns.push_back(i);
    velocities.push_back(VelocityOf(recording.points, weights, i));
  }
  for (Eigen::Index c = 0; c < recording.controller_count(); ++c) {
    known.columns.push_back(recording.particle_count() + c);
    velocities.push_back(VelocityOf(recording.controllers, weights, c));
  }
  const auto count = static_cast<Eigen::Index>(velocities.size());
  known.place.resize(3, count);
  known.velocity.resize(3, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    known.place.col(k) = recording.start.col(known.columns[k]);
    known.velocity.col(k) = velocities[k];
  }
  return known;
}

// The mean of the nearest known ones, weighted by 1 / distance^2. Returns how far the nearest is.
double Interpolate(const NeighbourSearch& search, const Points& velocities,
                   const Eigen::Vector3d& place, Eigen::Ref<Eigen::Vector3d> velocity) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weights = 0;
  const std::vector<Neighbour> near = search.Nearest(place, kMoveAlike);
  for (const Neighbour& one : near) {
    const double weight = 1 / std::max(one.distance * one.distance, 1e-14);
    sum += weight * velocities.col(one.index);
    weights += weight;
  }
  velocity = sum / weights;
  return near[0].distance;
}

// Whether v makes most of the second step, beyond what noise does, and is about the same over half
// the time. A start from rest that gets faster and faster gives a much smaller v there. One that
// vibrates from frame to frame goes back in the second step.
bool StartsInMotion(const Recording& recording, const Parabolas& parabolas,
                    const MotionScale& scale) {
  const int frames = static_cast<int>(parabolas.weights.size());
  const Parabolas half = LayParabolas(recording, std::max(kFewestParabolaFrames, (frames + 1) / 2));
  double from_velocity = 0, from_half = 0, along = 0, second_step = 0, count = 0;
  for (Eigen::Index i = 0; i < recording.point_count(); ++i) {
    if (!SeenInAll(recording.points, frames, i)) continue;
    const Eigen::Vector3d step = VelocityOf(recording.points, parabolas.weights, i) / recording.fps;
    from_velocity += step.squaredNorm();
    from_half += step.dot(VelocityOf(recording.points, half.weights, i) / recording.fps);
    const Eigen::Vector3d second = recording.points[2].col(i) - recording.points[1].col(i);
    along += step.dot(second);
    second_step += second.squaredNorm();
    ++count;
  }
  const double variance = 3 * scale.noise * scale.noise * count;  // of noise along three axes
  const double error = variance * parabolas.weights.squaredNorm() / std::pow(recording.fps, 2);
  const double step = std::max(second_step - 2 * variance, 0.0);
  return from_velocity > std::pow(kRounding * scale.size, 2) * count &&
         from_velocity > kSignificant * kSignificant * error &&
         from_velocity > kInMotion * kInMotion * step && from_half > kSame * from_velocity &&
         along > kSame * from_velocity;
}

// Whether the first step may be that of a body that was held at rest and is let go: the hands stand
// still, and it goes down, no further than a free fall. A stiff one swings within a few frames, and
// what it does first looks like a velocity.
bool MayBeLetGo(const Recording& recording, double noise) {
  constexpr double kStill = 0.2;      // of a free fall
  constexpr double kFurthest = 1.1;   // of a free fall
  constexpr double kDownwards = 0.7;  // a cosine
  const double gravity = recording.gravity.norm();
  if (gravity == 0) return false;
  const double fall = 0.5 * gravity / std::pow(recording.fps, 2);
  const Points hands = recording.controllers[1] - recording.controllers[0];
  if (hands.size() > 0 && hands.colwise().norm().maxCoeff() > kStill * fall) return false;
  double square = 0, down = 0, count = 0;
  for (Eigen::Index i = 0; i < recording.point_count(); ++i) {
    if (!SeenInAll(recording.points, 2, i)) continue;
    const Eigen::Vector3d step = recording.points[1].col(i) - recording.points[0].col(i);
    square += step.squaredNorm() - 6 * noise * noise;
    down += step.dot(recording.gravity) / gravity;
    ++count;
  }
  const double length = std::sqrt(std::max(square, 0.0) * count);  // sum of steps all alike
  return down > kDownwards * length && length < kFurthest * fall * count;
}

}  // namespace

std::optional<StartVelocity> EstimateStartVelocity(const Recording& recording) {
  if (recording.frame_count() < kFewestParabolaFrames + 1 ||
      recording.train_frames < kFewestParabolaFrames) {
    return std::nullopt;
  }
  const MotionScale scale = ScaleOf(recording);
  const Parabolas parabolas = LongestParabolas(recording, scale.noise);
  if (!StartsInMotion(recording, parabolas, scale) || MayBeLetGo(recording, scale.noise)) {
    return std::nullopt;
  }
  const Known known = KnownVelocities(recording, parabolas.weights);
  StartVelocity start{Points::Zero(3, recording.particle_count()),
                      static_cast<int>(parabolas.weights.size()), true};
  const NeighbourSearch search(known.place);
  for (Eigen::Index i = 0; i < recording.particle_count(); ++i) {
    const double distance =
        Interpolate(search, known.velocity, recording.start.col(i), start.velocity.col(i));
    if (distance > kFarInterior * scale.size) start.measured = false;
  }
  return start;
}

}  // namespace physpring
