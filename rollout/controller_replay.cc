// SPDX-License-Identifier: Apache-2.0
#include "rollout/controller_replay.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "rollout/exported_object.h"
#include "rollout/scene_ground.h"
#include "rollout/video_file.h"
#include "twin/error.h"
#include "twin/hierarchy.h"
#include "twin/lift.h"
#include "twin/predict.h"
#include "twin/recorded_input.h"

namespace physpring {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// The level of the twin that the object is.
int FindLevel(const ExportedObject& object, const Recording& recording, const Twin* twin,
              const std::string& scene) {
  if (object.controller_count() != recording.controller_count()) {
    throw Error(fmt::format("{}: has {} controllers, but recording {} has {}", scene,
                            object.controller_count(), recording.name,
                            recording.controller_count()));
  }
  if (twin == nullptr) {
    if (object.node_count() == recording.particle_count()) return 0;
    throw Error(fmt::format(
        "{}: has {} nodes, but recording {} has {} particles: is it of this object? If it is, a "
        "level above 0 needs its twin",
        scene, object.node_count(), recording.name, recording.particle_count()));
  }
  ExpectSameObject(*twin, recording);
  for (std::size_t level = 0; level < twin->levels.size(); ++level) {
    if (twin->levels[level].system.node_count() == object.node_count()) {
      return static_cast<int>(level);
    }
  }
  throw Error(fmt::format("{}: has {} nodes, as no level of twin {}", scene, object.node_count(),
                          twin->name));
}

// Corners of a box around all that the recording saw.
std::pair<Eigen::Vector3d, Eigen::Vector3d> BoxOf(const Recording& recording) {
  Eigen::Vector3d low = recording.start.rowwise().minCoeff();
  Eigen::Vector3d high = recording.start.rowwise().maxCoeff();
  for (const auto* frames : {&recording.points, &recording.controllers}) {
    for (const Points& frame : *frames) {
      for (const auto& point : frame.colwise()) {
        if (std::isnan(point[0])) continue;
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
      }
    }
  }
  return {low, high};
}

// Draws the video as the simulation goes, with the measured points as marks.
class Film {
 public:
  Film(const mjModel& model, const std::string& scene, const Recording& recording,
       const ReplayOptions& options)
      : model_(model),
        recording_(recording),
        painter_(model, options.quality, options.width, options.height),
        video_(options.video, options.width * std::max(1, static_cast<int>(options.cameras.size())),
               options.height, recording.fps) {
    for (const std::string& name : options.cameras) {
      views_.push_back(FindCamera(model, name, scene));
    }
    if (!views_.empty()) return;
    const auto [low, high] = BoxOf(recording);
    views_.push_back(OverviewOf(model, low, high));
  }

  void Add(int frame, mjData* data) {
    PlaceForDrawing(model_, data);
    std::vector<Image> images;
    for (const mjvCamera& view : views_) {
      images.push_back(painter_.Paint(data, view, recording_.points[frame]));
    }
    video_.Add(SideBySide(images));
  }

  void Finish() { video_.Finish(); }

 private:
  const mjModel& model_;
  const Recording& recording_;
  Painter painter_;
  VideoFile video_;
  std::vector<mjvCamera> views_;
};

// One frame: the controllers go evenly from where they were in the frame before, and are in each
// step where they are at its end, as in the trainer. on_level makes nodes of particles.
void RunFrame(const mjModel& model, const ExportedObject& object, const Recording& recording,
              const std::function<Points(const Points&)>& on_level, int frame, int steps,
              mjData* data) {
  const Points& from = recording.controllers[frame - 1];
  const Points& to = recording.controllers[frame];
  const Points velocity = (to - from) * recording.fps;
  if (recording.held.size() > 0) {
    FrameInput input = RecordedInput(recording, frame, 0);
    if (input.attached.any()) input.attached.nodes = on_level(input.attached.nodes);
    object.SetGrasps(input.released, input.attached, data);
  }
  for (int step = 1; step <= steps; ++step) {
    object.SetControllers(from + (to - from) * (static_cast<double>(step) / steps), velocity, data);
    Step(model, data);
  }
  mj_kinematics(&model, data);
}

}  // namespace

ControllerReplay ReplayControllers(const std::string& scene, const Recording& recording,
                                   const Twin* twin, const ReplayOptions& options) {
  ControllerReplay replay;
  const ModelPtr model = LoadScene(scene, &replay.warnings);
  if (!options.video.empty()) {
    PreparePictures(options.quality, options.width, options.height, model.get());
  }
  replay.steps = FitTimestep(recording.fps, model.get());
  replay.timestep = model->opt.timestep;
  const ExportedObject object(*model, scene);
  replay.nodes = object.node_count();
  replay.level = FindLevel(object, recording, twin, scene);

  const Points start = recording.start.leftCols(recording.particle_count());
  std::optional<Lift> lift;
  if (replay.level > 0) lift.emplace(*twin, replay.level, start);
  const auto on_level = [&](const Points& particles) {
    return lift ? AverageOverMembers(*twin, replay.level, particles) : particles;
  };
  const DataPtr data = MakeData(*model);
  mj_kinematics(model.get(), data.get());
  object.SetNodes(on_level(start), on_level(recording.velocity), data.get());
  const Points& controllers = recording.controllers[0];
  object.SetControllers(controllers, Points::Zero(3, controllers.cols()), data.get());
  object.StartControllers(controllers, data.get());
  mj_kinematics(model.get(), data.get());

  if (const std::string other = OtherGround(*model, *data, recording); !other.empty()) {
    replay.warnings.push_back(scene + ": " + other);
  }
  std::optional<Film> film;
  if (!options.video.empty()) film.emplace(*model, scene, recording, options);
  for (int frame = 0; frame < recording.frame_count(); ++frame) {
    if (options.progress) options.progress(frame);
    auto begin = Clock::now();
    try {
      if (frame > 0) RunFrame(*model, object, recording, on_level, frame, replay.steps, data.get());
    } catch (const Error& error) {
      throw Error(fmt::format("{}: in frame {} {}", scene, frame, error.what()));
    }
    const Points nodes = object.Nodes(*data);
    replay.physics += SecondsSince(begin);
    replay.particles.push_back(lift ? lift->Apply(nodes) : nodes);
    begin = Clock::now();
    if (film) film->Add(frame, data.get());
    replay.rendering += SecondsSince(begin);
  }
  if (film) film->Finish();
  return replay;
}

}  // namespace physpring
