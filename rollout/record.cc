// SPDX-License-Identifier: Apache-2.0
#include "rollout/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>

#include "rollout/flex_points.h"
#include "rollout/mocap_path.h"
#include "rollout/observation.h"
#include "rollout/scene.h"
#include "twin/error.h"

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

bool CanCollide(const mjModel& model, int geom) {
  return (model.geom_contype[geom] & model.flex_conaffinity[0]) != 0 ||
         (model.geom_conaffinity[geom] & model.flex_contype[0]) != 0;
}

// The plane under the object, and warnings of what else is in the way.
void FindGround(const mjModel& model, const mjData& data, const std::string& where,
                Recording* recording) {
  if (model.opt.disableflags & mjDSBL_CONTACT) return;
  int others = 0;
  for (int geom = 0; geom < model.ngeom; ++geom) {
    if (!CanCollide(model, geom)) continue;
    const bool ground =
        model.geom_type[geom] == mjGEOM_PLANE && model.body_weldid[model.geom_bodyid[geom]] == 0;
    if (!ground) {
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
        fmt::format("{}: the flex can collide with {} geom(s) that a recording does not hold (only "
                    "one ground plane)",
                    where, others));
  }
}

// One scene in motion.
struct Run {
  const mjModel& model;
  const MocapPath& path;
  const FlexPoints& flex;
  mjData* data;

  // Positions and velocities of the present state, with the mocap bodies where they are at `time`.
  void PlaceAt(double time) {
    path.Place(time, data);
    ComputeKinematics();
  }

  void ComputeKinematics() {
    mj_kinematics(&model, data);
    mj_comPos(&model, data);
    mj_flex(&model, data);
    mj_comVel(&model, data);
  }

  // From `time` by one step, the mocap bodies being where they are at its end.
  void StepFrom(double time, const std::string& where) {
    path.Place(time + model.opt.timestep, data);
    try {
      Step(model, data);
    } catch (const Error& error) {
      throw Error(fmt::format("{}: at {:.3f} s {}", where, time, error.what()));
    }
  }

  // Positions of points, interior and controllers, 3 x (N+M+C).
  Points AllPositions() const {
    Points all(3, particles() + static_cast<Eigen::Index>(flex.controllers.size()));
    all << VertexPositions(*data, flex.points), VertexPositions(*data, flex.interior),
        VertexPositions(*data, flex.controllers);
    return all;
  }

  Points ParticleVelocities() const {
    Points all(3, particles());
    all << VertexVelocities(model, *data, flex.points),
        VertexVelocities(model, *data, flex.interior);
    return all;
  }

  Eigen::Index particles() const {
    return static_cast<Eigen::Index>(flex.points.size() + flex.interior.size());
  }
};

// The state at time 0: rest, start, velocities, interior, ground.
void RecordStart(const Points& rest, const std::string& where, Run* run, Recording* recording) {
  run->PlaceAt(0);
  recording->start = run->AllPositions();
  recording->rest = rest;
  recording->rest_given = rest != recording->start;
  recording->velocity = run->ParticleVelocities();
  recording->interior = VertexPositions(*run->data, run->flex.interior);
  FindGround(run->model, *run->data, where, recording);
}

// Steps through the scene and records exact points and controllers.
void RecordMotion(int frames, const std::string& where, Run* run, Recording* recording) {
  // the reference configuration, then the first keyframe's
  run->ComputeKinematics();
  const Points rest = run->AllPositions();
  mj_resetDataKeyframe(&run->model, run->data, 0);

  const double h = run->model.opt.timestep;
  const auto steps = std::lround(1 / (recording->fps * h));  // a frame
  const auto settling = std::lround(std::ceil(std::max(0.0, -run->path.start_time()) / h - 1e-6));
  for (long step = -settling; step < 0; ++step) run->StepFrom(static_cast<double>(step) * h, where);
  RecordStart(rest, where, run, recording);
  for (long frame = 0; frame < frames; ++frame) {
    run->PlaceAt(static_cast<double>(frame * steps) * h);
    recording->points.push_back(VertexPositions(*run->data, run->flex.points));
    recording->controllers.push_back(VertexPositions(*run->data, run->flex.controllers));
    if (frame + 1 == frames) break;
    for (long step = frame * steps; step < (frame + 1) * steps; ++step) {
      run->StepFrom(static_cast<double>(step) * h, where);
    }
  }
}

}  // namespace

Recording RecordScene(const std::string& scene_path, const RecordOptions& options) {
  CheckOptions(options, scene_path);
  Recording recording;
  const ModelPtr model = LoadScene(scene_path, &recording.warnings);
  const FlexPoints flex = FindFlexPoints(*model, scene_path);
  MocapPath path(*model, scene_path);
  path.Vary(options.vary, SeedFor(Use::kVary, options.seed));
  const int frames = FrameCount(options, path, scene_path);

  recording.name = std::filesystem::path(scene_path).stem().string();
  recording.fps = options.fps;
  recording.mass = flex.mass;
  recording.gravity = Eigen::Map<const Eigen::Vector3d>(model->opt.gravity);
  if (model->opt.disableflags & mjDSBL_GRAVITY) recording.gravity.setZero();
  recording.train_frames = static_cast<int>(std::lround(0.7 * frames));

  // the longest step, not above the scene's, that divides the frame
  model->opt.timestep =
      1 / (options.fps * std::ceil(1 / (options.fps * model->opt.timestep) - 1e-6));
  const DataPtr data = MakeData(*model);
  Run run{*model, path, flex, data.get()};
  RecordMotion(frames, scene_path, &run, &recording);

  AddOcclusion(options.occlusion, options.fps, SeedFor(Use::kOcclusion, options.seed),
               &recording.points);
  AddNoise(options.noise, SeedFor(Use::kNoise, options.seed), &recording.points);
  return recording;
}

}  // namespace physpring
