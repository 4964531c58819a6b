// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <optional>

#include "jobs/checkpoint.h"
#include "jobs/remarks.h"
#include "jobs/train_options_json.h"
#include "jobs/training.h"
#include "python/bindings/bindings.h"
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

FitData DataOf(const std::vector<const GivenRecording*>& given) {
  if (given.empty()) throw Error("no recording is given");
  std::vector<RecordingEntry> entries;
  std::vector<Recording> recordings;
  for (const GivenRecording* one : given) {
    entries.push_back(one->entry);
    recordings.push_back(one->recording);
  }
  return CollectFitData(entries, std::move(recordings));
}

// Warnings that were not there when the recordings were given.
std::vector<std::string> NewWarnings(const std::vector<const GivenRecording*>& given,
                                     const FitData& data) {
  std::vector<std::string> added;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const std::vector<std::string>& before = given[i]->recording.warnings;
    const std::vector<std::string>& now = data.recordings[i].warnings;
    added.insert(added.end(), now.begin() + static_cast<std::ptrdiff_t>(before.size()), now.end());
  }
  return added;
}

nb::tuple Train(const std::vector<const GivenRecording*>& recordings, const Wishes& wishes,
                const nb::object& callback) {
  TrainingTask task{DataOf(recordings), OptionsOf(wishes), std::nullopt};
  Warn(NewWarnings(recordings, task.data));
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
  FitReport report;
  RunWatched(callback, [&](const TellShare& tell) {
    run = RunTraining(task, checkpoint, wishes.resume, wishes.checkpoint_interval, tell);
    if (run.stopped) throw Stopped();
    report = JudgeTraining(task, run.twin);
    tell(1, run.status);
  });
  Warn(report.warnings);
  if (wishes.output.empty()) run.twin.name = recordings[0]->recording.name;
  const std::string path = wishes.output.empty() ? run.twin.name : wishes.output;
  return nb::make_tuple(GivenTwin{path, run.twin}, report.line, run.parts);
}

}  // namespace

void BindTraining(nb::module_& module) {
  module.def(
      "train",
      [](const std::vector<const GivenRecording*>& recordings, const std::string& options_json,
         std::uint64_t seed, int threads, const GivenTwin* from, const GivenTwin* effects,
         const std::string& output, bool resume, bool force, double checkpoint_interval,
         const nb::object& callback) {
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
