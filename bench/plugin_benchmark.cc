// SPDX-License-Identifier: Apache-2.0
// The same rope in MuJoCo with native tendons and with physpring.springs: one step of 50 us, and
// 20 ms of simulated time with tendons at 50 us, with the plugin at 2 ms (40 sub-steps inside), and
// with the bare kernel. difference_m: from the simulator, after 20 ms.
#include <benchmark/benchmark.h>

#include <cmath>

#include "bench/rope.h"
#include "tests/support/level_scene.h"
#include "twin/simulator.h"

namespace physpring {
namespace {

constexpr int kNodes = 2000, kSprings = 30000;
constexpr double kSubstep = 50e-6, kStep = 2e-3, kTime = 20e-3;  // s

const SpringMassSystem& Rope() {
  static const SpringMassSystem rope = MakeRope(kNodes, kSprings);
  return rope;
}

// Moving as if it had been shaken.
Points Velocity() {
  Points velocity(3, kNodes);
  for (int i = 0; i < kNodes; ++i) {
    velocity.col(i) = Eigen::Vector3d(0, std::sin(7 * i), std::cos(3 * i)) * 0.1;
  }
  return velocity;
}

LevelScene Scene(bool plugin, double timestep) {
  LevelScene scene(Rope(), {.plugin_springs = plugin, .timestep = timestep, .substep = kSubstep});
  scene.SetState(Rope().position, Velocity());
  return scene;
}

void OneStep(benchmark::State& state, bool plugin) {
  const LevelScene scene = Scene(plugin, kSubstep);
  for (auto _ : state) mj_step(&scene.model(), scene.data());
}

void Simulate(benchmark::State& state, bool plugin, double timestep) {
  LevelScene scene = Scene(plugin, timestep);
  const int steps = static_cast<int>(std::lround(kTime / timestep));
  for (auto _ : state) {
    state.PauseTiming();
    mj_resetData(&scene.model(), scene.data());
    scene.SetState(Rope().position, Velocity());
    state.ResumeTiming();
    for (int i = 0; i < steps; ++i) mj_step(&scene.model(), scene.data());
  }
  Simulator<double> simulator(
      Rope(), {}, {.frame_time = kTime, .substeps = static_cast<int>(kTime / kSubstep)});
  Simulator<double>::Workspace workspace(simulator);
  NodeStates<double> nodes = simulator.MakeState(Rope().position, Velocity());
  simulator.AdvanceFrame({Points(3, 0), Points(3, 0), {}}, &nodes, &workspace);
  state.counters["difference_m"] =
      (simulator.Positions(nodes) - scene.Positions()).colwise().norm().maxCoeff();
}

void BareKernel(benchmark::State& state) {
  const Simulator<double> simulator(
      Rope(), {},
      {.frame_time = kStep, .substeps = static_cast<int>(std::lround(kStep / kSubstep))});
  Simulator<double>::Workspace workspace(simulator);
  NodeStates<double> nodes = simulator.MakeState(Rope().position, Velocity());
  for (auto _ : state) {
    for (int i = 0; i < std::lround(kTime / kStep); ++i) {
      simulator.AdvanceFrame({Points(3, 0), Points(3, 0), {}}, &nodes, &workspace);
    }
  }
}

BENCHMARK_CAPTURE(OneStep, tendons, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(OneStep, plugin, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Simulate, tendons_50us, false, kSubstep)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Simulate, plugin_2ms, true, kStep)->Unit(benchmark::kMillisecond);
BENCHMARK(BareKernel)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace physpring

BENCHMARK_MAIN();
