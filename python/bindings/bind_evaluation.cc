// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "jobs/evaluation.h"
#include "jobs/image_evaluation.h"
#include "python/bindings/arrays.h"
#include "python/bindings/given_recordings.h"
#include "python/bindings/watched_work.h"
#include "report/eval_report.h"
#include "report/picture/page.h"
#include "twin/error.h"
#include "twin/parallel.h"
#include "twin/regrasp.h"

namespace physpring {
namespace {

// Of other methods: (T, particles, 3) in m.
using GivenPredictions = std::map<std::string, Numbers<3>>;

std::vector<Baseline> BaselinesOf(const GivenPredictions& given, const Recording& recording) {
  std::vector<Baseline> baselines;
  for (const auto& [name, array] : given) {
    ExpectPredictionName(name);
    const std::string what = "prediction " + name;
    std::vector<Points> frames = FramesFrom(array, recording.particle_count(), what.c_str());
    const auto count = static_cast<int>(frames.size());
    if (count != recording.frame_count()) {
      throw Error(fmt::format("{} has {} frames, but the recording has {}", what, count,
                              recording.frame_count()));
    }
    baselines.push_back({name, name, std::move(frames)});
  }
  return baselines;
}

Evaluation EvaluateAll(const GivenTwin& twin, const GivenRecordings& recordings,
                       EvaluationOptions options, const GivenPredictions& predictions,
                       ImageOptions images, int threads) {
  if (recordings.empty()) throw Error("no recording is given");
  Checked(twin);
  const bool of_one = !predictions.empty() || !images.pictures.empty();
  if (of_one && recordings.size() > 1) {
    throw Error(fmt::format("predictions and images are of one recording; there are {}",
                            recordings.size()));
  }
  if (!predictions.empty()) {
    options.others = BaselinesOf(predictions, RecordingFor(twin.twin, *recordings[0]));
  }
  Evaluation evaluation{twin.path, twin.twin, options.predict.single_precision, options.anchor, {}};
  const int count = static_cast<int>(recordings.size());
  evaluation.recordings.resize(recordings.size());
  RunWatched(nb::none(), [&](const TellShare& /*tell*/) {
    ParallelFor(count, threads, [&](int i) {
      evaluation.recordings[i] = EvaluateRecording(
          twin.twin, recordings[i]->entry, RecordingFor(twin.twin, *recordings[i]), options);
    });
    if (images.pictures.empty()) return;
    images.threads = threads;
    evaluation.recordings[0].images = EvaluateImages(images, evaluation.recordings.data());
  });
  std::vector<std::string> warnings;
  for (int i = 0; i < count; ++i) {
    AddNewWarnings(*recordings[i], evaluation.recordings[i].recording, &warnings);
  }
  Warn(warnings);
  Warn(WarningsOf(evaluation));
  return evaluation;
}

const LevelResult& ResultOf(const Evaluation& evaluation, std::size_t recording,
                            std::size_t level) {
  if (recording >= evaluation.recordings.size() ||
      level >= evaluation.recordings[recording].result.levels.size()) {
    throw nb::index_error("no such recording or level");
  }
  return evaluation.recordings[recording].result.levels[level];
}

NumpyDoubles PredictNodes(const GivenTwin& twin, const GivenRecording& given, int level,
                          std::optional<int> substeps, bool single_precision) {
  Recording recording = RecordingFor(Checked(twin), given);
  ExpectSameObject(twin.twin, recording);
  const Twin held = HeldAsIn(&recording, twin.twin);
  std::vector<Points> motion;
  RunWatched(nb::none(), [&](const TellShare& /*tell*/) {
    motion = Predict(held, level, recording, {single_precision, substeps.value_or(0)});
  });
  return CopyOf(motion);
}

}  // namespace

void BindEvaluation(nb::module_& module) {
  nb::class_<Evaluation> evaluation(module, "EvaluationResult");
  evaluation.def("json", &FormatJson);
  evaluation.def("text", &FormatTables);
  evaluation.def("html", &FormatPage);
  evaluation.def(
      "points",
      [](const Evaluation& self, std::size_t recording, std::size_t level) {
        return CopyOf(ResultOf(self, recording, level).points);
      },
      nb::arg("recording"), nb::arg("level"));
  evaluation.def(
      "errors",
      [](const Evaluation& self, std::size_t recording, std::size_t level) {
        return CopyOf(ResultOf(self, recording, level).lifted.track);
      },
      nb::arg("recording"), nb::arg("level"));
  module.def(
      "evaluate",
      [](const GivenTwin& twin, const GivenRecordings& recordings, std::optional<int> substeps,
         bool single_precision, std::optional<int> anchor, const GivenPredictions& predictions,
         const std::string& pictures, const std::string& splats,
         const std::vector<std::string>& cameras, int threads) {
        return EvaluateAll(twin, recordings,
                           {{single_precision, substeps.value_or(0)}, anchor.value_or(0)},
                           predictions, {pictures, splats, cameras}, threads);
      },
      nb::arg("twin"), nb::arg("recordings"), nb::arg("substeps").none(),
      nb::arg("single_precision"), nb::arg("anchor").none(), nb::arg("predictions"),
      nb::arg("pictures"), nb::arg("splats"), nb::arg("cameras"), nb::arg("threads"));
  module.def("predict", &PredictNodes, nb::arg("twin"), nb::arg("recording"), nb::arg("level"),
             nb::arg("substeps").none(), nb::arg("single_precision"));
}

}  // namespace physpring
