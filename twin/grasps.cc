// SPDX-License-Identifier: Apache-2.0
#include "twin/grasps.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "twin/checks/motion_scale.h"
#include "twin/local_motion.h"
#include "twin/neighbours.h"
#include "twin/quiet_shape.h"
#include "twin/recorded_rod.h"

namespace physpring {
namespace {

// Those of two frames or more.
std::vector<Grasp> GraspsOf(const Recording& recording, int controller) {
  std::vector<Grasp> grasps;
  const auto held = recording.held.col(controller);
  for (int t = 0; t < held.size(); ++t) {
    if (!held[t]) continue;
    const int first = t;
    while (t + 1 < held.size() && held[t + 1]) ++t;
    if (t > first) grasps.push_back({controller, first, t});
  }
  return grasps;
}

// NaN where a controller does not hold becomes the place before, or the first one after.
void FillReleased(const NpzFields& fields, Recording* recording) {
  std::vector<Points>& frames = recording->controllers;
  const int count = static_cast<int>(frames.size());
  for (int c = 0; c < recording->held.cols(); ++c) {
    int known = -1;
    for (int t = 0; t < count; ++t) {
      if (frames[t].col(c).allFinite()) {
        for (int before = 0; known < 0 && before < t; ++before)
          frames[before].col(c) = frames[t].col(c);
        known = t;
      } else if (recording->held(t, c)) {
        fields.Fail("controllers",
                    fmt::format("holds nan at [{}, {}], where 'held' says that it holds", t, c));
      } else if (known >= 0) {
        frames[t].col(c) = frames[known].col(c);
      }
    }
    if (GraspsOf(*recording, c).empty()) {
      fields.Fail("held",
                  fmt::format("says that controller {} holds in no two frames in a row", c));
    }
  }
}

// The points of a frame. Those that are not seen in it are between where they were seen just before
// and just after, if they were.
Points SeenAbout(const std::vector<Points>& frames, int frame) {
  constexpr int kAbout = 5;  // frames, either way
  const int last = static_cast<int>(frames.size()) - 1;
  const auto sees = [&](int t, Eigen::Index i) {
    return frames[static_cast<std::size_t>(t)].col(i).allFinite();
  };
  Points shape = frames[static_cast<std::size_t>(frame)];
  for (Eigen::Index i = 0; i < shape.cols(); ++i) {
    if (sees(frame, i)) continue;
    int before = frame, after = frame;
    while (before > std::max(0, frame - kAbout) && !sees(before, i)) --before;
    while (after < std::min(last, frame + kAbout) && !sees(after, i)) ++after;
    if (!sees(before, i) || !sees(after, i)) continue;
    const Eigen::Vector3d from = frames[static_cast<std::size_t>(before)].col(i);
    const Eigen::Vector3d to = frames[static_cast<std::size_t>(after)].col(i);
    shape.col(i) = from + (frame - before) / static_cast<double>(after - before) * (to - from);
  }
  return shape;
}

// Whether most of the points near a place of frame 0 are known in a shape.
bool AreMostKnown(const Points& start, const Points& shape, const Eigen::Vector3d& place) {
  constexpr int kNear = 8;
  int known = 0, near = 0;
  for (const Neighbour& one : NeighbourSearch(start).Nearest(place, kNear)) {
    known += shape.col(one.index).allFinite() ? 1 : 0;
    ++near;
  }
  return 2 * known > near;
}

// Its columns of start, rest and order, where the grasp does not begin in frame 0.
void PlaceLateGrasp(const NpzFields& fields, const Grasp& grasp, const Recording& read, int column,
                    Recording* recording) {
  if (read.point_count() == 0) {
    fields.Fail("held", fmt::format("says that controller {} takes hold in frame {}; in clouds "
                                    "without 'points' all hold from frame 0 on",
                                    grasp.controller, grasp.first));
  }
  const int particles = read.particle_count();
  const Points start = read.start.leftCols(read.point_count());
  const Points shape = SeenAbout(read.points, grasp.first);
  const std::optional<Eigen::Vector3d> place =
      LocalMotion(shape, start)
          .Move(read.controllers[static_cast<std::size_t>(grasp.first)].col(grasp.controller));
  if (!place) {
    fields.Fail("points", fmt::format("sees nothing in frame {}, in which controller {} takes hold",
                                      grasp.first, grasp.controller));
  }
  if (!AreMostKnown(start, shape, *place)) {
    recording->warnings.push_back(fmt::format(
        "{}: few of the points around controller {} are seen when it takes hold in frame "
        "{}, so what it holds is a guess",
        fields.path(), grasp.controller, grasp.first));
  }
  recording->start.col(particles + column) = *place;
  recording->rest.col(particles + column) =
      *LocalMotion(start, read.rest.leftCols(read.point_count())).Move(*place);
  if (!read.rod.empty()) recording->rod.arc[particles + column] = ArcLengthAt(read, *place);
}

// The path of a controller while it holds; before and after it stands still.
void SetPath(const Grasp& grasp, const Recording& read, int column, Recording* recording) {
  for (int t = 0; t < read.frame_count(); ++t) {
    const auto at = static_cast<std::size_t>(t);
    const auto from = static_cast<std::size_t>(std::clamp(t, grasp.first, grasp.last));
    recording->controllers[at].col(column) = read.controllers[from].col(grasp.controller);
    recording->held(t, column) = t >= grasp.first && t <= grasp.last;
    if (!read.force.empty()) {
      recording->force[at].col(column) = read.force[at].col(grasp.controller);
      if (!recording->held(t, column)) recording->force[at].col(column).setConstant(std::nan(""));
    }
  }
}

}  // namespace

std::vector<Grasp> AllGrasps(const Recording& recording) {
  std::vector<Grasp> first, others;
  for (int c = 0; c < recording.held.cols(); ++c) {
    const std::vector<Grasp> own = GraspsOf(recording, c);
    first.push_back(own.at(0));
    others.insert(others.end(), own.begin() + 1, own.end());
  }
  first.insert(first.end(), others.begin(), others.end());
  return first;
}

void ReadControllers(NpzFields& fields, const std::string& frames, Recording* recording) {
  if (!fields.Has("held")) {
    recording->controllers = fields.Frames("controllers", "C", frames);
    return;
  }
  recording->controllers = fields.FramesWithUnseen("controllers", "C", frames);
  recording->held = fields.Flags("held", frames, "C");
  FillReleased(fields, recording);
}

void SplitGrasps(const NpzFields& fields, Recording* recording) {
  if (recording->held.size() == 0) return;
  const Recording read = *recording;
  const std::vector<Grasp> grasps = AllGrasps(read);
  const int particles = read.particle_count(), count = static_cast<int>(grasps.size());
  recording->held.resize(read.frame_count(), count);
  for (Points& frame : recording->controllers) frame.resize(3, count);
  for (Eigen::MatrixXd& frame : recording->force) frame.resize(frame.rows(), count);
  for (Points* shape : {&recording->start, &recording->rest}) {
    shape->conservativeResize(3, particles + count);
  }
  if (!read.rod.empty()) recording->rod.arc.conservativeResize(particles + count);
  for (int i = 0; i < count; ++i) {
    const Grasp& grasp = grasps[static_cast<std::size_t>(i)];
    SetPath(grasp, read, i, recording);
    if (grasp.first > 0) PlaceLateGrasp(fields, grasp, read, i, recording);
  }
  KeepHoldingControllers(*recording, &recording->rod);
  FindShapesWhenHeld(recording);
}

bool HasChangingGrasps(const Recording& recording) {
  return recording.held.size() > 0 && !recording.held.all();
}

void FindShapesWhenHeld(Recording* recording) {
  recording->shape_when_held.clear();
  const Points start = recording->start.leftCols(recording->particle_count());
  const double noise = MeasurementNoise(recording->points);
  for (int t = 1; t < recording->held.rows(); ++t) {
    if (!(recording->held.row(t) && !recording->held.row(t - 1)).any()) continue;
    Points shape = Points::Constant(3, start.cols(), std::nan(""));
    shape.leftCols(recording->point_count()) = SeenAbout(recording->points, t);
    shape = QuietShape(start, shape, noise);
    const LocalMotion motion(start, shape);
    for (Eigen::Index i = 0; i < shape.cols(); ++i) {
      if (!shape.col(i).allFinite())
        shape.col(i) = motion.Move(start.col(i)).value_or(start.col(i));
    }
    recording->shape_when_held[t] = shape;
  }
}

}  // namespace physpring
