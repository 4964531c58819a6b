// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "report/info_text.h"
#include "twin/checks/objects.h"
#include "twin/grasps.h"
#include "twin/ground.h"

namespace physpring {
namespace {

using Json = nlohmann::ordered_json;

// What can be told from the positions alone.
struct Measured {
  double missing_fraction = 0;      // the part of all points in all frames that is not seen
  int frames_without_data = 0;      // how many frames see no point
  double largest_displacement = 0;  // m, the farthest that a point is from its start
  // m, the size in frame 0 of points and interior, or else of the cloud
  Eigen::Vector3d extent{0, 0, 0};
  double start_speed = 0;  // m/s, of the fastest particle
};

Measured Measure(const Recording& recording) {
  Measured measured;
  Eigen::Index missing = 0;
  for (const Points& frame : recording.points) {
    Eigen::Index seen = 0;
    for (Eigen::Index i = 0; i < frame.cols(); ++i) {
      if (!frame.col(i).allFinite()) continue;
      ++seen;
      measured.largest_displacement =
          std::max(measured.largest_displacement, (frame.col(i) - recording.start.col(i)).norm());
    }
    missing += frame.cols() - seen;
    measured.frames_without_data += frame.cols() > 0 && seen == 0;
  }
  const double all = static_cast<double>(recording.frame_count()) * recording.point_count();
  if (all > 0) measured.missing_fraction = static_cast<double>(missing) / all;
  const bool clouds_alone = recording.particle_count() == 0;
  const Points start =
      clouds_alone ? recording.surface[0] : recording.start.leftCols(recording.particle_count());
  for (int k = 0; k < 3; ++k) {
    measured.extent[k] = start.row(k).maxCoeff<Eigen::PropagateNumbers>() -
                         start.row(k).minCoeff<Eigen::PropagateNumbers>();
  }
  if (!clouds_alone) measured.start_speed = recording.velocity.colwise().norm().maxCoeff();
  return measured;
}

// Of clouds alone nothing is followed, so nobody can say how they move.
std::string DescribePoints(const Recording& recording, const Measured& measured) {
  if (recording.point_count() == 0) return "none; `physpring register` makes them of clouds";
  return fmt::format("{}, {:.1f} % of their positions not seen{}", recording.point_count(),
                     100 * measured.missing_fraction,
                     measured.frames_without_data > 0
                         ? fmt::format(", {} frames without any", measured.frames_without_data)
                         : "");
}

double MeasuredForces(const Recording& recording) {
  double measured = 0, all = 0;
  for (const Eigen::MatrixXd& frame : recording.force) {
    measured += static_cast<double>((!frame.array().isNaN()).count());
    all += static_cast<double>(frame.size());
  }
  return measured / all;
}

std::string DescribeForces(const Recording& recording) {
  return fmt::format("{}, {:.1f} % of them measured",
                     recording.force[0].rows() == 1 ? "sizes" : "vectors",
                     100 * MeasuredForces(recording));
}

Json ForcesToJson(const Recording& recording) {
  if (recording.force.empty()) return nullptr;
  return {{"components", recording.force[0].rows()},
          {"measured_fraction", MeasuredForces(recording)}};
}

// The first and the last frame in which each controller holds.
Json HeldFrames(const Recording& recording) {
  if (recording.held.size() == 0) return nullptr;
  Json frames;
  for (const Grasp& one : AllGrasps(recording)) frames.push_back({one.first, one.last});
  return frames;
}

std::string DescribeControllers(const Recording& recording) {
  std::string text = fmt::format("{}", recording.controller_count());
  if (recording.held.size() == 0) return text;
  std::map<std::pair<int, int>, int> counts;
  for (const Grasp& one : AllGrasps(recording)) ++counts[{one.first, one.last}];
  std::vector<std::string> parts;
  for (const auto& [frames, count] : counts) {
    parts.push_back(fmt::format("{} in frames {} to {}", count, frames.first, frames.second));
  }
  return fmt::format("{}, one for each time that one holds: {}", text, fmt::join(parts, ", "));
}

std::string DescribeRod(const Rod& rod) {
  const int joints = RodJoints(rod);
  std::string text = fmt::format("{:.3f} m long", RodLength(rod));
  if (joints > 0) text += fmt::format(" in all, {} {}", joints, joints == 1 ? "joint" : "joints");
  return text;
}

Eigen::Index PointColumns(const std::vector<Points>& frames) {
  return frames.empty() ? 0 : frames[0].cols();
}

Json ToJson(const Eigen::VectorXd& values) {
  return Json(std::vector<double>(values.begin(), values.end()));
}

}  // namespace

std::string DescribeRecording(const Recording& recording) {
  const Measured measured = Measure(recording);
  const int frames = recording.frame_count();
  std::string text;
  const auto line = [&](const char* name, const std::string& value) {
    text += fmt::format("{:<12} {}\n", name, value);
  };
  line("frames", fmt::format("{} at {:g} fps, {:.2f} s; the first {} are for fitting", frames,
                             recording.fps, (frames - 1) / recording.fps, recording.train_frames));
  line("points", DescribePoints(recording, measured));
  line("interior", fmt::format("{}", recording.interior_count()));
  line("controllers", DescribeControllers(recording));
  if (recording.two_clocks) line("clocks", "the controllers have one of their own");
  if (ObjectCount(recording) > 1) line("objects", fmt::format("{}", ObjectCount(recording)));
  if (!recording.force.empty()) line("force", DescribeForces(recording));
  if (!recording.surface.empty())
    line("surface", fmt::format("{}", PointColumns(recording.surface)));
  if (!recording.track.empty())
    line("key points", fmt::format("{}", PointColumns(recording.track)));
  const Eigen::Vector3d& extent = measured.extent;
  line("size",
       fmt::format("{:.3f} x {:.3f} x {:.3f} m in frame 0", extent.x(), extent.y(), extent.z()));
  if (recording.point_count() > 0) {
    line("motion",
         fmt::format("up to {:.3f} m from where it starts", measured.largest_displacement));
    line("start", measured.start_speed > 0
                      ? fmt::format("in motion, up to {:.2f} m/s", measured.start_speed)
                      : "at rest");
  }
  line("rest shape", recording.rest_given ? "given" : "frame 0");
  if (!recording.rod.empty()) line("rod", DescribeRod(recording.rod));
  line("mass", fmt::format("{:g} kg", recording.mass));
  line("gravity", fmt::format("{:g} {:g} {:g} m/s^2", recording.gravity.x(), recording.gravity.y(),
                              recording.gravity.z()));
  line("ground", DescribeGround(recording.ground));
  line("hash", recording.hash);
  return text;
}

Json RecordingToJson(const Recording& recording) {
  const Measured measured = Measure(recording);
  return {{"kind", "recording"},
          {"name", recording.name},
          {"hash", recording.hash},
          {"frames", recording.frame_count()},
          {"train_frames", recording.train_frames},
          {"fps", recording.fps},
          {"duration_s", (recording.frame_count() - 1) / recording.fps},
          {"points", recording.point_count()},
          {"interior", recording.interior_count()},
          {"controllers", recording.controller_count()},
          {"held_frames", HeldFrames(recording)},
          {"two_clocks", recording.two_clocks},
          {"force", ForcesToJson(recording)},
          {"objects", ObjectCount(recording)},
          {"surface", PointColumns(recording.surface)},
          {"track", PointColumns(recording.track)},
          {"missing_fraction", measured.missing_fraction},
          {"frames_without_data", measured.frames_without_data},
          {"size_m", ToJson(measured.extent)},
          {"largest_displacement_m", measured.largest_displacement},
          {"rest_given", recording.rest_given},
          {"rod_length_m", recording.rod.empty() ? Json(nullptr) : Json(RodLength(recording.rod))},
          {"rod_joints", RodJoints(recording.rod)},
          {"mass_kg", recording.mass},
          {"gravity_m_s2", ToJson(recording.gravity)},
          {"ground", recording.ground ? ToJson(*recording.ground) : Json(nullptr)},
          {"start_speed_m_s", measured.start_speed},
          {"warnings", recording.warnings},
          {"notes", recording.notes}};
}

}  // namespace physpring
