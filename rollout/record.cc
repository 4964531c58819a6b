// SPDX-License-Identifier: Apache-2.0
#include "rollout/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>

#include "rollout/mocap_path.h"
#include "rollout/observation.h"
#include "rollout/scene.h"
#include "rollout/soft_points.h"
#include "rollout/undeclared_effects.h"
#include "twin/error.h"
#include "twin/stop_request.h"

namespace physpring {
namespace {

// What the seed is used for, each with random numbers of its own.
enum class Use : std::uint32_t { kVary, kNoise, kOcclusion };

std::uint64_t SeedFor(Use use, std::uint64_t seed) {
  std::seed_seq mix{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                    static_cast<std::uint32_t>(use)};
  std::uint32_t words[2];
  mix.generate(words, words + 2);
  return (static_cast<std::uint64_t>(words[0]) << 32) | words[1];
}

void CheckOptions(const RecordOptions& options, const std::string& where) {
  const auto check = [&](bool good, const char* name, double value, const char* expected) {
    if (!good) throw Error(fmt::format("{}: {} is {}; must be {}", where, name, value, expected));
  };
  const auto finite_from_zero = [](double value) { return std::isfinite(value) && value >= 0; };
  const double occlusion = options.occlusion, duration = options.duration.value_or(1);
  check(finite_from_zero(options.noise), "noise", options.noise, "0 m or more");
  check(finite_from_zero(options.vary), "vary", options.vary, "0 m or more");
  check(occlusion >= 0 && occlusion < 1, "occlusion", occlusion, "in [0, 1)");
  check(std::isfinite(options.fps) && options.fps > 0, "fps", options.fps, "above 0");
  check(std::isfinite(duration) && duration > 0, "duration", duration, "above 0 s");
}

// Frames at k / fps, k = 0, 1 ..., up to the duration.
int FrameCount(const RecordOptions& options, const MocapPath& path, const std::string& where) {
  const double duration = options.duration.value_or(path.end_time());
  const double frames = std::floor(duration * options.fps + 1e-6) + 1;
  if (frames < 2 || frames > 1e6) {
    throw Error(
        fmt::format("{}: {} frames ({} s at {} fps); 2 to 1000000 are possible; the last "
                    "keyframe's time, or the "
                    "duration given, is that of the last frame",
                    where, frames, duration, options.fps));
  }
  return static_cast<int>(frames);
}

// The plane under the object, and warnings of what else is in the way.
void FindGround(const mjModel& model, const mjData& data, const SoftPoints& soft,
                const std::string& where, Recording* recording) {
  int others = 0;
  for (const int geom : GeomsInTheWay(model, soft)) {
    if (!IsGround(model, geom)) {
      ++others;
      continue;
    }
    if (recording->ground) throw Error(where + ": has two ground planes; a recording holds one");
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> axes(data.geom_xmat +
                                                                              9 * geom);
    const Eigen::Vector3d normal = axes.col(2).normalized();
    const Eigen::Map<const Eigen::Vector3d> origin(data.geom_xpos + 3 * geom);
    recording->ground = Eigen::Vector4d(normal[0], normal[1], normal[2], normal.dot(origin));
  }
  if (others > 0) {
    recording->warnings.push_back(
        fmt::format("{}: the {} can collide with {} geom(s) that a recording does not hold (only "
                    "one ground plane)",
                    where, soft.of_flex ? "flex" : "soft body", others));
  }
}

// One scene in motion.
struct RecordingRun {
  mjModel* model;
  const MocapPath& path;
  const SoftPoints& soft;
  const UndeclaredEffects& effects;
  mjData* data;
  std::function<void(double part)> progress;
  long lag = 0;  // steps by which the mocap bodies move later than is recorded

  double TimeOf(long step) const { return static_cast<double>(step) * model->opt.timestep; }

  // Positions and velocities of the present state, with the mocap bodies where they are before
  // that step.
  void PlaceAt(long step) {
    path.Place(TimeOf(step - lag), data);
    ComputeKinematics();
  }

  void ComputeKinematics() {
    mj_kinematics(model, data);
    mj_comPos(model, data);
    mj_flex(model, data);
    mj_comVel(model, data);
  }

  // By one step, the mocap bodies being where they are at its end.
  void Advance(long step, const std::string& where) {
    StopIfRequested();
    path.Place(TimeOf(step - lag) + model->opt.timestep, data);
    effects.Drive(TimeOf(step), model, data);
    try {
      Step(*model, data);
    } catch (const Error& error) {
      throw Error(fmt::format("{}: at {:.3f} s {}", where, TimeOf(step), error.what()));
    }
  }

  // Positions of points, interior and controllers, 3 x (N+M+C).
  Points AllPositions() const {
    const std::vector<int> particles = soft.Particles();
    Points all(3, static_cast<Eigen::Index>(particles.size() + soft.controllers.size()));
    all << PositionsOf(*data, soft, particles), PositionsOf(*data, soft, soft.controllers);
    return all;
  }
};

// The state at time 0: rest, start, velocities, interior, ground.
void RecordStart(const Points& rest, const std::string& where, RecordingRun* run,
                 Recording* recording) {
  run->PlaceAt(0);
  recording->start = run->AllPositions();
  recording->rest = rest;
  recording->rest_given = rest != recording->start;
  recording->velocity = VelocitiesOf(*run->model, *run->data, run->soft, run->soft.Particles());
  recording->interior = PositionsOf(*run->data, run->soft, run->soft.interior);
  FindGround(*run->model, *run->data, run->soft, where, recording);
}

// Steps through the scene and records exact points and controllers. With a lag, a frame's
// controllers are those of so many steps later. Pictures are taken with the points.
void RecordMotion(long frames, const std::string& where, RecordingRun* run, Recording* recording,
                  PictureRecorder* pictures) {
  // the reference configuration, then the first keyframe's
  run->ComputeKinematics();
  const Points rest = run->AllPositions();
  mj_resetDataKeyframe(run->model, run->data, 0);

  const double h = run->model->opt.timestep;
  const long steps = std::lround(1 / (recording->fps * h));  // a frame
  const long settling = std::lround(std::ceil(std::max(0.0, -run->path.start_time()) / h - 1e-6));
  for (long step = -settling; step < 0; ++step) run->Advance(step, where);
  RecordStart(rest, where, run, recording);
  const long end = (frames - 1) * steps + run->lag;
  for (long step = 0; step <= end; ++step) {
    const long later = step - run->lag;
    const bool points = step % steps == 0 && step / steps < frames;
    const bool controllers = later >= 0 && later % steps == 0;
    if (points || controllers) run->PlaceAt(step);
    if (points) {
      recording->points.push_back(PositionsOf(*run->data, run->soft, run->soft.points));
      if (pictures != nullptr) pictures->Record(static_cast<int>(step / steps), *run->data);
      if (run->progress) run->progress(static_cast<double>(step) / static_cast<double>(end));
    }
    if (controllers) {
      recording->controllers.push_back(PositionsOf(*run->data, run->soft, run->soft.controllers));
    }
    if (step < end) run->Advance(step, where);
  }
  recording->start.rightCols(recording->controller_count()) = recording->controllers[0];
  if (!recording->rest_given) recording->rest = recording->start;
}

}  // namespace

Recording RecordScene(const std::string& scene_path, const RecordOptions& options) {
  CheckOptions(options, scene_path);
  Recording recording;
  const ModelPtr declared = LoadScene(scene_path, &recording.warnings);
  const SoftPoints declared_points = FindSoftPoints(*declared, scene_path);
  const UndeclaredEffects effects(options.effects, *declared, declared_points, scene_path);
  const ModelPtr model = effects.empty()
                             ? ModelPtr(mj_copyModel(nullptr, declared.get()))
                             : EditScene(scene_path, [&](mjSpec* spec) { effects.Edit(spec); });
  effects.Change(model.get());
  const SoftPoints soft = FindSoftPoints(*model, scene_path);
  MocapPath path(*model, scene_path);
  path.Vary(options.vary, SeedFor(Use::kVary, options.seed));
  const int frames = FrameCount(options, path, scene_path);

  recording.name = std::filesystem::path(scene_path).stem().string();
  recording.fps = options.fps;
  recording.mass = declared_points.mass;
  recording.gravity = Eigen::Map<const Eigen::Vector3d>(declared->opt.gravity);
  if (declared->opt.disableflags & mjDSBL_GRAVITY) recording.gravity.setZero();
  recording.train_frames = std::max(2, static_cast<int>(std::lround(0.7 * frames)));

  FitTimestep(options.fps, model.get());
  const DataPtr data = MakeData(*model);
  RecordingRun run{model.get(), path, soft, effects, data.get(), options.progress};
  run.lag = std::lround(effects.latency() / model->opt.timestep);
  std::optional<PictureRecorder> pictures;
  if (const PictureOptions& asked = options.pictures; !asked.folder.empty()) {
    PreparePictures(asked.quality, asked.width, asked.height, model.get());
    model->vis.quality.offsamples = 0;  // smooth edges would have depths that nothing has
    pictures.emplace(*model, soft, asked, scene_path);
  }
  RecordMotion(frames, scene_path, &run, &recording, pictures ? &*pictures : nullptr);
  if (pictures) pictures->Finish(options.fps, frames);

  AddOcclusion(options.occlusion, options.fps, SeedFor(Use::kOcclusion, options.seed),
               &recording.points);
  AddNoise(options.noise, SeedFor(Use::kNoise, options.seed), &recording.points);
  return recording;
}

}  // namespace physpring
