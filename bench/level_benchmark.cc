// SPDX-License-Identifier: Apache-2.0
// How much faster the coarser levels of a hierarchy are: a frame of 1/30 s of a rope of 2,000 nodes
// and 30,000 springs and of its projections to 60, 40 and 30 % of the nodes (k-means), float, on
// the ground, one thread. `equal`: as many sub-steps as level 0 needs; `own`: as many as the level
// needs. Each time a frame of level 0 is timed beside it. Times are CPU time; `speed_up`: that of
// level 0 over the level's; `fps`: frames a second.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <ctime>
#include <vector>

#include "bench/rope.h"
#include "trainer/projection/galerkin.h"
#include "trainer/reduction/kmeans.h"
#include "twin/simulator.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr double kFrameTime = 1.0 / 30;  // s
constexpr double kRatios[] = {0.6, 0.4, 0.3};

std::vector<SpringMassSystem> MakeLevels() {
  std::vector<SpringMassSystem> levels = {MakeRope(2000, 30000)};
  for (const double ratio : kRatios) {
    const int nodes = static_cast<int>(ratio * levels[0].node_count());
    const Assignment assignment = KMeansAssignment(levels.back(), nodes, 1);
    levels.push_back(Project(levels.back(), assignment, Eigen::Vector3d::UnitZ()).system);
  }
  return levels;
}

int OwnSubsteps(const SpringMassSystem& system) {
  return StableSubsteps(ComputeStabilityBound(system), kFrameTime, kStepSafety);
}

// Frames of one level.
class Level {
 public:
  Level(const SpringMassSystem& system, int substeps)
      : simulator_(system, {.ground = Eigen::Vector4d(0, 0, 1, 0)},
                   {.frame_time = kFrameTime, .substeps = substeps}),
        workspace_(simulator_),
        state_(simulator_.MakeState(system.position, Points::Zero(3, system.node_count()))),
        input_{Points(3, 0), Points(3, 0), {}} {}

  // CPU time of the next one, s.
  double Advance() {
    const std::clock_t start = std::clock();
    simulator_.AdvanceFrame(input_, &state_, &workspace_);
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  }

 private:
  Simulator<float> simulator_;
  Simulator<float>::Workspace workspace_;
  NodeStates<float> state_;
  FrameInput input_;
};

void Measure(benchmark::State& state, const SpringMassSystem& dense, const SpringMassSystem& system,
             int substeps) {
  Level reference(dense, OwnSubsteps(dense)), level(system, substeps);
  double reference_time = 0, time = 0;
  for (auto _ : state) {
    reference_time += reference.Advance();
    const double frame = level.Advance();
    time += frame;
    state.SetIterationTime(frame);
  }
  state.counters["substeps"] = substeps;
  state.counters["fps"] = static_cast<double>(state.iterations()) / time;
  state.counters["speed_up"] = reference_time / time;
}

void Register(const std::vector<SpringMassSystem>& levels) {
  for (const bool own : {false, true}) {
    for (std::size_t k = 0; k < levels.size(); ++k) {
      const int substeps = OwnSubsteps(levels[own ? k : 0]);
      benchmark::RegisterBenchmark(fmt::format("{}/level{}/{}/{}", own ? "own" : "equal", k,
                                               levels[k].node_count(), levels[k].spring_count())
                                       .c_str(),
                                   Measure, levels[0], levels[k], substeps)
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond);
    }
  }
}

}  // namespace
}  // namespace physpring

int main(int argc, char** argv) {
  const std::vector<physpring::SpringMassSystem> levels = physpring::MakeLevels();
  physpring::Register(levels);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
}
