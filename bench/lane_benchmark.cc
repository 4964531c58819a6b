// SPDX-License-Identifier: Apache-2.0
// Rollouts side by side against one after the other: 8 ropes of the same springs with other
// stiffnesses, a frame of 100 sub-steps, one thread.
//   lane_benchmark --benchmark_repetitions=9
// `alone` and `side_by_side` alternate within each iteration, so that both see the same machine.
// Counter `ratio`: the time alone over the time side by side, in the same run. `ground`: the ropes
// rest on a ground.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <ctime>
#include <vector>

#include "bench/rope.h"
#include "twin/lane_kernels.h"
#include "twin/lane_simulator.h"

namespace physpring {
namespace {

constexpr int kSubsteps = 100;  // a frame

struct Case {
  int nodes, springs, rollouts;
  bool ground;
};

double Seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

template <class Real>
class Ropes {
 public:
  Ropes(const Case& ropes, const LaneKernel<Real>& kernel)
      : input_{Points(3, 0), Points(3, 0), {}} {
    const SpringMassSystem rope = MakeRope(ropes.nodes, ropes.springs);
    std::vector<SpringMassSystem> systems(ropes.rollouts, rope);
    for (int i = 0; i < ropes.rollouts; ++i) systems[i].stiffness *= 1 + 0.001 * i;
    Environment environment;
    if (ropes.ground) environment.ground = Eigen::Vector4d(0, 0, 1, 0);
    const SimulationOptions options{.frame_time = kSubsteps / 20010.0, .substeps = kSubsteps};
    for (const SpringMassSystem& system : systems) {
      alone_.emplace_back(system, environment, options);
      workspaces_.emplace_back(alone_.back());
      start_.push_back(alone_.back().MakeState(rope.position, Points::Zero(3, ropes.nodes)));
    }
    for (int first = 0; first < ropes.rollouts; first += kernel.lanes) {
      const int end = std::min(ropes.rollouts, first + kernel.lanes);
      side_by_side_.push_back(std::make_unique<LaneSimulator<Real>>(
          std::vector<SpringMassSystem>(systems.begin() + first, systems.begin() + end),
          environment, options, kernel));
    }
  }

  void Alone() {
    states_ = start_;
    for (std::size_t i = 0; i < alone_.size(); ++i) {
      alone_[i].AdvanceFrame(input_, &states_[i], &workspaces_[i]);
    }
    benchmark::DoNotOptimize(states_);
  }
  void SideBySide(int lanes) {
    states_ = start_;
    std::size_t first = 0;
    for (auto& simulator : side_by_side_) {
      std::vector<NodeStates<Real>*> states;
      for (int l = 0; l < lanes && first < states_.size(); ++l) states.push_back(&states_[first++]);
      simulator->AdvanceFrame(std::vector<FrameInput>(states.size(), input_), states);
    }
    benchmark::DoNotOptimize(states_);
  }

 private:
  std::vector<Simulator<Real>> alone_;
  std::vector<typename Simulator<Real>::Workspace> workspaces_;
  std::vector<std::unique_ptr<LaneSimulator<Real>>> side_by_side_;
  FrameInput input_;
  std::vector<NodeStates<Real>> start_, states_;
};

template <class Real>
void Measure(benchmark::State& state, const Case& measured, const LaneKernel<Real>& kernel) {
  Ropes<Real> ropes(measured, kernel);
  double alone = 0, side_by_side = 0;
  for (auto _ : state) {
    const double start = Seconds();
    ropes.Alone();
    const double middle = Seconds();
    ropes.SideBySide(kernel.lanes);
    alone += middle - start;
    side_by_side += Seconds() - middle;
  }
  const double rollouts = static_cast<double>(state.iterations()) * measured.rollouts;
  state.counters["alone_us"] = 1e6 * alone / rollouts / kSubsteps;
  state.counters["side_us"] = 1e6 * side_by_side / rollouts / kSubsteps;
  state.counters["ratio"] = alone / side_by_side;
}

template <class Real>
void Register(const char* precision) {
  constexpr int kSizes[][2] = {{100, 800}, {500, 4500}, {2000, 30000}};
  for (const auto& size : kSizes) {
    for (const char* name : {"avx2", "avx512"}) {
      const LaneKernel<Real>* kernel = FindLaneKernel<Real>(name);
      if (kernel == nullptr) continue;
      for (int rollouts : {8, 16}) {
        for (bool ground : {false, true}) {
          benchmark::RegisterBenchmark(
              fmt::format("{}/{}/{}/{}/{}/{}", precision, name, ground ? "ground" : "free", size[0],
                          size[1], rollouts)
                  .c_str(),
              Measure<Real>, Case{size[0], size[1], rollouts, ground}, *kernel)
              ->MinTime(0.3);
        }
      }
    }
  }
}

}  // namespace
}  // namespace physpring

int main(int argc, char** argv) {
  physpring::Register<float>("float");
  physpring::Register<double>("double");
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
}
