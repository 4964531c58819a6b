// SPDX-License-Identifier: Apache-2.0
#include "rollout/scene.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "rollout/mujoco_log.h"
#include "rollout/scene_spec.h"
#include "twin/atomic_file.h"
#include "twin/error.h"

namespace physpring {
namespace {

ModelPtr Compile(mjSpec* spec, const std::string& where, std::vector<std::string>* warnings) {
  mjModel* model = nullptr;
  CatchMujoco(
      where, [&] { model = mj_compile(spec, nullptr); }, warnings);
  if (!model) throw Error(where + ": " + OneLine(mjs_getError(spec)));
  return ModelPtr(model);
}

}  // namespace

ModelPtr LoadScene(const std::string& path, std::vector<std::string>* warnings) {
  ExpectRegularFile(path);
  std::array<char, 1024> message{};
  mjModel* model = nullptr;
  CatchMujoco(
      path, [&] { model = mj_loadXML(path.c_str(), nullptr, message.data(), message.size()); },
      warnings);
  if (!model) throw Error(path + ": " + OneLine(message.data()));
  return ModelPtr(model);
}

ModelPtr EditScene(const std::string& path, const SceneEdit& edit) {
  std::vector<std::string> ignored;
  const SpecPtr spec = ParseSpec(path, &ignored);
  edit(spec.get());
  return Compile(spec.get(), path, &ignored);
}

ModelPtr CompileScene(const std::string& mjcf, const std::string& where, const SceneEdit& edit) {
  std::vector<std::string> warnings;
  const SpecPtr spec = ParseSpecText(mjcf, where, &warnings);
  edit(spec.get());
  ModelPtr model = Compile(spec.get(), where, &warnings);
  if (!warnings.empty()) throw Error(warnings.front());
  return model;
}

int FitTimestep(double fps, mjModel* model) {
  constexpr double kMostSteps = 1e6;
  const double steps = std::ceil(1 / (fps * model->opt.timestep) - 1e-6);
  if (!(steps <= kMostSteps)) {
    throw Error(
        fmt::format("the scene's timestep of {} s gives {} steps in a frame of {} s, "
                    "expected at most {}",
                    model->opt.timestep, steps, 1 / fps, kMostSteps));
  }
  model->opt.timestep = 1 / (fps * steps);
  return static_cast<int>(steps);
}

DataPtr MakeData(const mjModel& model) {
  mjData* data = nullptr;
  CatchMujoco([&] { data = mj_makeData(&model); });
  if (!data) throw Error("MuJoCo: not enough memory for the scene's data");
  return DataPtr(data);
}

void Step(const mjModel& model, mjData* data) {
  const std::vector<std::string> warnings = CatchMujoco([&] { mj_step(&model, data); });
  if (!warnings.empty()) throw Error("MuJoCo: " + warnings.front());
}

}  // namespace physpring
