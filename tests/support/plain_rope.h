// SPDX-License-Identifier: Apache-2.0
// A rope that shares no code with the simulator: point masses in a row, Hooke's springs and
// dashpots between neighbours, semi-implicit Euler. The first one is moved by a hand, the others
// are seen with noise.
#ifndef PHYSPRING_TESTS_SUPPORT_PLAIN_ROPE_H_
#define PHYSPRING_TESTS_SUPPORT_PLAIN_ROPE_H_

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "twin/recording.h"

namespace physpring {

struct PlainRope {
  int masses = 12;
  double spacing = 0.05;                               // m, of the slack rope
  double stiffness = 300, dashpot = 0.5, mass = 5e-3;  // of each
  double drag = 1;                                     // 1/s
  double fps = 60;
  int frames = 120;
  double noise = 5e-4;    // m
  double before = 0;      // s of motion before frame 0
  double released = 1e9;  // s, when the hand lets go
  Eigen::Vector3d hangs_from{0, 0, 1};
  Eigen::Vector3d along{0, 0, -1};  // from there at the start
  double floor = -1e9;              // height of one without friction, m
  unsigned seed = 1;
  std::function<Eigen::Vector3d(double)> hand = [](double t) {  // m, from where it holds at t = 0
    return Eigen::Vector3d(0.1 * std::sin(5 * t), 0.05 * std::sin(7 * t), 0);
  };

  Recording Record() const;
};

inline Recording PlainRope::Record() const {
  const Eigen::Vector3d gravity(0, 0, -9.81);
  Points x(3, masses), v = Points::Zero(3, masses);
  for (int i = 0; i < masses; ++i) x.col(i) = hangs_from + hand(-before) + i * spacing * along;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, noise);
  const int steps = 60;
  const double h = 1 / (fps * steps);
  const int first = static_cast<int>(std::lround(before * fps)) * steps;
  Recording recording;
  recording.name = "rope";
  for (int step = 0; step <= first + (frames - 1) * steps; ++step) {
    const double t = (step - first) * h;
    if (t < released) x.col(0) = hangs_from + hand(t);
    if (step >= first && (step - first) % steps == 0) {
      recording.points.emplace_back(
          x.rightCols(masses - 1).unaryExpr([&](double value) { return value + normal(random); }));
      recording.controllers.emplace_back(hangs_from + hand(t));
    }
    Points force = mass * (gravity.replicate(1, masses) - drag * v);
    for (int i = 0; i + 1 < masses; ++i) {
      const Eigen::Vector3d d = x.col(i + 1) - x.col(i);
      const Eigen::Vector3d u = d.normalized();
      const Eigen::Vector3d f =
          (stiffness * (d.norm() - spacing) + dashpot * (v.col(i + 1) - v.col(i)).dot(u)) * u;
      force.col(i) += f;
      force.col(i + 1) -= f;
    }
    v += h / mass * force;
    if (t < released) v.col(0).setZero();
    for (int i = 0; i < masses; ++i) {
      if (x(2, i) <= floor) v(2, i) = std::max(v(2, i), 0.0);
    }
    x += h * v;
  }
  recording.fps = fps;
  recording.mass = mass * (masses - 1);
  recording.gravity = gravity;
  recording.interior.resize(3, 0);
  recording.velocity = Points::Zero(3, masses - 1);
  recording.train_frames = frames * 7 / 10;
  recording.start.resize(3, masses);
  recording.start << recording.points[0], recording.controllers[0];
  recording.rest = recording.start;
  return recording;
}

// Every position of the recording, controllers included, moved by `map`.
inline Recording Mapped(Recording recording,
                        const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& map) {
  const auto apply = [&](Points* points) {
    for (Eigen::Index i = 0; i < points->cols(); ++i) points->col(i) = map(points->col(i));
  };
  for (Points& frame : recording.points) apply(&frame);
  for (Points& frame : recording.controllers) apply(&frame);
  apply(&recording.start);
  apply(&recording.rest);
  return recording;
}

// Two recordings of the same times as if they were one.
inline Recording SideBySide(const Recording& a, const Recording& b) {
  Recording both = a;
  const auto join = [](const Points& left, const Points& right) {
    Points joined(3, left.cols() + right.cols());
    joined << left, right;
    return joined;
  };
  for (int t = 0; t < a.frame_count(); ++t) {
    both.points[t] = join(a.points[t], b.points[t]);
    both.controllers[t] = join(a.controllers[t], b.controllers[t]);
  }
  both.start = both.rest = join(both.points[0], both.controllers[0]);
  both.velocity = Points::Zero(3, both.point_count());
  both.mass = a.mass + b.mass;
  return both;
}

// Two ropes 3 cm apart, each moved by its own hand.
inline Recording TwoRopes() {
  PlainRope one, other;
  other.seed = 2;
  other.hangs_from = {0.03, 0.03, 1};
  other.hand = [](double t) { return Eigen::Vector3d(0, 0.1 * std::sin(5 * t), 0); };
  return SideBySide(one.Record(), other.Record());
}

// A rope that hangs at rest, stretched by its own weight, before the hand begins to move.
inline PlainRope HangingRope(double mass_of_each) {
  PlainRope rope;
  rope.mass = mass_of_each;
  rope.before = 8;
  rope.hand = [](double t) {
    const double begins = std::clamp(2 * t, 0.0, 1.0);
    return Eigen::Vector3d(0.12 * std::sin(5.6 * t) * begins, 0.06 * std::sin(8 * t) * begins, 0);
  };
  return rope;
}

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_PLAIN_ROPE_H_
