// SPDX-License-Identifier: Apache-2.0
#include "twin/checks/grasp.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "twin/checks/smooth_motion.h"
#include "twin/column_names.h"
#include "twin/neighbours.h"

namespace physpring {
namespace {

constexpr double kNoLever = 0.05;   // of the object's size: controllers so near to a line
constexpr double kOddTorque = 0.6;  // of |arm| |a - g|
constexpr double kAbove = -0.7;     // cosine of the angle between the arm and gravity
constexpr double kLongArm = 0.2;    // of the object's size
constexpr double kFarSpacings = 2, kFarSize = 0.15;  // of a controller from all particles
constexpr int kHeld = 3;                             // points nearest to a controller
constexpr double kReleased = 8, kReleasedSize = 0.3;

// How the controllers of frame 0 lie about the axis along which they are spread most.
struct Spread {
  Eigen::Vector3d axis;
  double about_axis, about_centre;  // root mean square distances, m
};

Spread SpreadOf(const Points& controllers) {
  const Points centred = controllers.colwise() - controllers.rowwise().mean();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(
      centred * centred.transpose() / static_cast<double>(controllers.cols()));
  const Eigen::Vector3d squares = axes.eigenvalues().cwiseMax(0);
  return {axes.eigenvectors().col(2), std::sqrt(squares[0] + squares[1]), std::sqrt(squares.sum())};
}

std::string Direction(const Eigen::Vector3d& v) {
  return fmt::format("({:.2f}, {:.2f}, {:.2f})", v[0], v[1], v[2]);
}

}  // namespace

std::string OddGravity(const Recording& recording, const MotionScale& scale) {
  if (recording.held.size() > 0) return "";  // it may hang from another one in each frame
  const std::vector<Pull> pulls = Pulls(recording);
  if (recording.ground || pulls.empty() || recording.gravity.norm() == 0) return "";
  Eigen::Vector3d arm = Eigen::Vector3d::Zero(), torque = arm;
  double most = 0;
  for (const Pull& pull : pulls) {
    arm += pull.arm / static_cast<double>(pulls.size());
    torque += pull.arm.cross(pull.force);
    most += pull.arm.norm() * pull.force.norm();
  }
  if (arm.norm() < kLongArm * scale.size) return "";
  const Spread spread = SpreadOf(recording.controllers[0]);
  const double line = kNoLever * scale.size;
  double held = 0;
  if (spread.about_centre < line) {
    held = torque.norm() / most;
  } else if (spread.about_axis < line) {
    held = std::abs(torque.dot(spread.axis)) / most;
  }
  const double down = arm.dot(recording.gravity) / (arm.norm() * recording.gravity.norm());
  if (held < kOddTorque && down > kAbove) return "";
  return fmt::format(
      "the object hangs from its controllers towards {}, but gravity is ({:.3g}, {:.3g}, {:.3g}) "
      "m/s^2: which axis points up?",
      Direction(arm.normalized()), recording.gravity[0], recording.gravity[1],
      recording.gravity[2]);
}

std::string FarGrasp(const Recording& recording, const MotionScale& scale) {
  const Points particles = recording.start.leftCols(recording.particle_count());
  if (particles.cols() < 2) return "";  // nothing says what is far
  const NeighbourSearch search(particles);
  for (int c = 0; c < recording.controller_count(); ++c) {
    const Eigen::Vector3d place = recording.start.col(recording.particle_count() + c);
    const double distance = search.Nearest(place, 1)[0].distance;
    if (distance < kFarSpacings * scale.spacing || distance < kFarSize * scale.size) continue;
    return fmt::format(
        "{} starts {:.3g} m from the nearest particle, where particles are {:.3g} m "
        "apart: is it where the object is held?",
        NameOfController(recording, c), distance, scale.spacing);
  }
  return "";
}

std::string ReleasedGrasp(const Recording& recording, const MotionScale& scale) {
  const Points points = recording.start.leftCols(recording.point_count());
  const NeighbourSearch search(points);
  if (recording.held.size() > 0) return "";  // it says so itself
  for (int c = 0; c < recording.controller_count(); ++c) {
    const std::vector<Neighbour> held = search.Nearest(recording.controllers[0].col(c), kHeld);
    double start = 0;
    for (const Neighbour& one : held) start += one.distance;
    start /= static_cast<double>(held.size());
    for (int t = 1; t < recording.frame_count(); ++t) {
      double sum = 0, seen = 0;
      for (const Neighbour& one : held) {
        const double distance =
            (recording.points[t].col(one.index) - recording.controllers[t].col(c)).norm();
        if (!std::isfinite(distance)) continue;
        sum += distance;
        ++seen;
      }
      if (seen == 0 || sum / seen < std::max(kReleased * start, start + kReleasedSize * scale.size))
        continue;
      return fmt::format(
          "controller {} is {:.3g} m from the points that it held at {:.3g} m, in frame {}: was "
          "the object released? The array 'held' tells",
          c, sum / seen, start, t);
    }
  }
  return "";
}

}  // namespace physpring
