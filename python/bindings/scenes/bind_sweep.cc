// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "python/bindings/scenes/scenes.h"
#include "python/bindings/watched_work.h"
#include "report/rollout_report.h"
#include "rollout/camera_thread.h"
#include "rollout/make_policy.h"
#include "rollout/mujoco_library.h"
#include "rollout/plugin_library.h"
#include "rollout/record.h"
#include "rollout/sweep.h"
#include "twin/error.h"
#include "twin/stop_request.h"

namespace physpring {
namespace {

namespace nb = nanobind;

nb::tuple SweepTask(const std::string& folder, const std::string& output,
                    const std::vector<int>& levels, const std::string& policy,
                    const std::string& policy_adapter, int first, int episodes, std::uint64_t seed,
                    double action_noise, double start_noise, int threads, bool states) {
  if (!IsPolicy(policy)) {
    throw Error("policy is '" + policy +
                "', expected scripted, random, replay:PATH or ws://HOST:PORT");
  }
  if (first < 0) throw Error("first is below 0, expected the number of an episode");
  Sweep sweep;
  RunWatched(nb::none(), [&](const TellShare& /*tell*/) {
    ExpectMujoco();
    LoadPluginLibrary();
    const Task task = ReadTask(folder);
    SweepOptions options;
    options.levels = levels;
    options.first = first;
    options.episodes = episodes;
    options.seed = seed;
    options.disturbance = {action_noise, start_noise};
    options.policy.text = policy;
    options.policy.adapter = policy_adapter;
    options.threads = threads;
    options.folder = output;
    options.states = states;
    SweepHooks hooks;
    hooks.prepare = [&task](mjModel* model) {
      PreparePictures(PictureQuality::kFast, task.width, task.height, model);
    };
    hooks.make_viewer = [](const TaskModel& model, int /*episode*/,
                           bool images) -> std::unique_ptr<Viewer> {
      if (!images) return nullptr;
      return MakeCameraThread(model, {PictureQuality::kFast, "", {}});
    };
    hooks.stop = [] {
      StopIfRequested();
      return false;
    };
    sweep = RunSweep(task, options, hooks);
    if (!sweep.complete) throw Stopped();
  });
  return nb::make_tuple(sweep.episodes.size(), sweep.warnings);
}

nb::tuple ReportOn(const std::vector<std::string>& folders) {
  const std::vector<JudgedPolicy> policies = ReadPolicies(folders);
  return nb::make_tuple(FormatJson(policies), FormatTables(policies));
}

void Record(const std::string& scene, const std::string& output, double noise, double occlusion,
            double vary, std::uint64_t seed, std::optional<double> duration, double fps,
            const std::map<std::string, double>& effects) {
  RunWatched(nb::none(), [&](const TellShare& /*tell*/) {
    ExpectMujoco();
    WriteRecording(
        RecordScene(scene, {noise, occlusion, vary, seed, duration, fps, SceneEffects(effects)}),
        output);
  });
}

}  // namespace

void BindSweep(nb::module_& module) {
  module.def("record", &Record, nb::arg("scene"), nb::arg("output"), nb::arg("noise"),
             nb::arg("occlusion"), nb::arg("vary"), nb::arg("seed"), nb::arg("duration").none(),
             nb::arg("fps"), nb::arg("effects"));
  module.def("sweep", &SweepTask, nb::arg("task"), nb::arg("output"), nb::arg("levels"),
             nb::arg("policy"), nb::arg("policy_adapter"), nb::arg("first"), nb::arg("episodes"),
             nb::arg("seed"), nb::arg("action_noise"), nb::arg("start_noise"), nb::arg("threads"),
             nb::arg("states"));
  module.def(
      "is_finished",
      [](const std::string& folder, int level, int episode) {
        return ReadEpisode(folder, level, episode).has_value();
      },
      nb::arg("folder"), nb::arg("level"), nb::arg("episode"));
  module.def("report", &ReportOn, nb::arg("folders"));
}

}  // namespace physpring
