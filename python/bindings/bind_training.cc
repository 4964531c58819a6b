// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <optional>

#include "jobs/checkpoint.h"
#include "jobs/train_options_json.h"
#include "jobs/training.h"
#include "python/bindings/given_recordings.h"
#include "python/bindings/watched_work.h"
#include "twin/atomic_file.h"
#include "twin/error.h"
#include "twin/output_lock.h"
#include "twin/stop_request.h"

namespace physpring {
namespace {

namespace nb = nanobind;

// What Python gives besides the recordings.
struct Wishes {
  std::string options_json;
  std::uint64_t seed;
  int threads;
  const GivenTwin *from, *effects;  // null: none
  std::string output;               // empty: no file
  bool resume, force;
  double checkpoint_interval;  // s
};

TrainOptions OptionsOf(const Wishes& wishes) {
  TrainOptions options = ParseTrainOptions(wishes.options_json);
  options.seed = wishes.seed;
  options.threads = wishes.threads;
  const auto error =
      CheckTrainOptions(options, {wishes.from != nullptr, wishes.effects != nullptr});
  if (error) throw Error("training option " + error->option + ": " + error->why);
  if (wishes.effects) options.effects = EffectsOf(wishes.effects->twin, wishes.effects->path);
  return options;
}

GivenTwin Train(const GivenRecordings& recordings, const Wishes& wishes,
                const nb::object& callback) {
  TrainingTask task{FitDataOf(recordings), OptionsOf(wishes), std::nullopt};
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    AddNewWarnings(*recordings[i], task.data.recordings[i], &warnings);
  }
  Warn(warnings);
  if (wishes.from) {
    ExpectLevel0Of(task.data, Checked(*wishes.from), wishes.from->path);
    task.dense = wishes.from->twin;
  }
  const std::string from = wishes.from ? wishes.from->path : "";
  const Checkpoint checkpoint(wishes.output, task.data, task.options, from);
  std::optional<OutputLock> lock;
  if (!wishes.output.empty()) {
    ExpectFileWritable(wishes.output);
    lock.emplace(wishes.output);
    checkpoint.ExpectReplaceable(wishes.resume || wishes.force);
  }
  TrainingRun run;
  RunWatched(callback, [&](const TellShare& tell) {
    run = RunTraining(task, checkpoint, wishes.resume, wishes.checkpoint_interval, tell);
    if (run.stopped) throw Stopped();
    tell(1, run.status);
  });
  Warn(run.fit.warnings);
  if (wishes.output.empty()) run.twin.name = recordings[0]->recording.name;
  const std::string path = wishes.output.empty() ? run.twin.name : wishes.output;
  return {path, run.twin};
}

}  // namespace

void BindTraining(nb::module_& module) {
  module.def(
      "train",
      [](const GivenRecordings& recordings, const std::string& options_json, std::uint64_t seed,
         int threads, const GivenTwin* from, const GivenTwin* effects, const std::string& output,
         bool resume, bool force, double checkpoint_interval, const nb::object& callback) {
        return Train(recordings,
                     {options_json, seed, threads, from, effects, output, resume, force,
                      checkpoint_interval},
                     callback);
      },
      nb::arg("recordings"), nb::arg("options_json"), nb::arg("seed"), nb::arg("threads"),
      nb::arg("from_twin").none(), nb::arg("effects_of").none(), nb::arg("output"),
      nb::arg("resume"), nb::arg("force"), nb::arg("checkpoint_interval"),
      nb::arg("callback").none());
}

}  // namespace physpring
