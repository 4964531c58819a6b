// SPDX-License-Identifier: Apache-2.0
// Scenes of one task side by side in one process, as TaskVectorEnv steps them: frames a second with
// one thread and with two, at level 3 of rope routing. Counters: frames_per_second, and
// kib_per_scene, by how much the process has grown for each scene. scene_batch [--benchmark_...]
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <fstream>
#include <memory>
#include <vector>

#include "rollout/plugin_library.h"
#include "rollout/stepped_episode.h"
#include "twin/parallel.h"

namespace physpring {
namespace {

constexpr int kLevel = 3;
constexpr int kFrames = 4;  // of each scene in an iteration

const TaskModel& Model() {
  static const Task task = ReadTask(PHYSPRING_MODELS "/scenes/rope_routing");
  static std::vector<std::string> warnings;
  static const TaskModel model = MakeTaskModel(task, kLevel, &warnings);
  return model;
}

// A scene under way, and the action that keeps its hand where it is.
struct Scene {
  Simulation simulation{Model()};
  EpisodeResult result;
  std::unique_ptr<SteppedEpisode> episode;
  Eigen::VectorXd action;

  explicit Scene(int number) {
    result.episode.start = StartOf(*Model().task, 1, number, {});
    episode = std::make_unique<SteppedEpisode>(Model(), &simulation, &result);
    episode->Begin();
    action = episode->observation().robot;
  }
};

// Bytes of memory that the process takes.
double InUse() {
  double pages = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

void StepScenes(benchmark::State& state) {
  const auto count = static_cast<int>(state.range(0)), threads = static_cast<int>(state.range(1));
  Model();
  const double before = InUse();
  std::vector<std::unique_ptr<Scene>> scenes(static_cast<std::size_t>(count));
  ParallelFor(count, 2, [&](int i) { scenes[i] = std::make_unique<Scene>(i); });
  for (auto _ : state) {
    for (int frame = 0; frame < kFrames; ++frame) {
      ParallelFor(count, threads, [&](int i) { scenes[i]->episode->Step(scenes[i]->action); });
    }
  }
  const double grown = InUse() - before;
  state.counters["frames_per_second"] = benchmark::Counter(
      static_cast<double>(count) * kFrames * static_cast<double>(state.iterations()),
      benchmark::Counter::kIsRate);
  state.counters["kib_per_scene"] = grown / count / 1024;
}

}  // namespace
}  // namespace physpring

int main(int argc, char** argv) {
  using physpring::StepScenes;
  physpring::LoadPluginLibrary(PHYSPRING_PLUGIN);
  benchmark::RegisterBenchmark("scenes", StepScenes)
      ->ArgNames({"count", "threads"})
      ->ArgsProduct({{1, 16, 64, 256}, {1, 2}})
      ->UseRealTime()
      ->Unit(benchmark::kMillisecond);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
