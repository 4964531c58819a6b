// SPDX-License-Identifier: Apache-2.0
// Time of a sub-step, forward and with its gradient, by precision, kernel and size:
//   substep_benchmark --benchmark_filter=gradient/double --benchmark_repetitions=9
// Counter `substep`: CPU time of one. `free`: without a ground, forward. `forward_EFFECT` and
// `gradient_EFFECT`: with an effect along the springs. `forward_stages4` and `gradient_stages4`:
// with dashpots in 4 stages. A rollout that does not fit into memory pays `forward` once more for
// its gradient.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <optional>

#include "bench/rope.h"
#include "twin/effects/registry.h"
#include "twin/simulator.h"

namespace physpring {
namespace {

constexpr int kSubsteps = 100;  // a frame

struct Case {
  int nodes, springs;
  bool ground;
  const Effect* effect = nullptr;  // along the springs
  int dashpot_stages = 1;

  SpringMassSystem System() const {
    SpringMassSystem system = MakeRope(nodes, springs);
    system.dashpot_stages = dashpot_stages;
    if (effect) system.effects = {{effect->name(), effect->Starts(system)[0]}};
    return system;
  }
  Environment Surroundings() const {
    return ground ? Environment{.ground = Eigen::Vector4d(0, 0, 1, 0)} : Environment();
  }
};

template <class Real>
class Rope {
 public:
  Rope(const Case& rope, const Kernel<Real>& kernel)
      : system_(rope.System()),
        simulator_(system_, rope.Surroundings(),
                   {.frame_time = kSubsteps / 20010.0, .substeps = kSubsteps}, kernel),
        workspace_(simulator_),
        gradient_(system_),
        start_(simulator_.MakeState(system_.position, Points::Zero(3, rope.nodes))) {
    input_.controllers_start = input_.controllers_end = Points(3, 0);
  }

  void Forward() {
    state_ = start_;
    simulator_.AdvanceFrame(input_, &state_, &workspace_);
    benchmark::DoNotOptimize(state_);
  }
  void Gradient() {
    state_ = start_;
    simulator_.RecordFrame(input_, &state_, &workspace_);
    simulator_.RecordedFrameAdjoint(&state_, &gradient_, &workspace_);
    benchmark::DoNotOptimize(gradient_);
  }

 private:
  SpringMassSystem system_;
  Simulator<Real> simulator_;
  typename Simulator<Real>::Workspace workspace_;
  SystemGradient gradient_;
  FrameInput input_;
  NodeStates<Real> start_, state_;
};

template <class Real>
void Measure(benchmark::State& state, void (Rope<Real>::*function)(), const Case& measured,
             const Kernel<Real>& kernel) {
  Rope<Real> rope(measured, kernel);
  for (auto _ : state) (rope.*function)();
  state.counters["substep"] = benchmark::Counter(
      kSubsteps, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

std::vector<const Effect*> EffectsAlongSprings() {
  std::vector<const Effect*> along;
  for (const Effect* effect : AllEffects()) {
    if (effect->MakeTension(Eigen::VectorXd::Zero(effect->value_count()))) along.push_back(effect);
  }
  return along;
}

template <class Real>
void Register(const char* precision) {
  constexpr int kSizes[][2] = {{45, 250}, {838, 7344}, {1050, 10099}, {1243, 13129}, {2000, 30000}};
  for (const auto& size : kSizes) {
    const int nodes = size[0], springs = size[1];
    for (std::string_view name : kKernelNames) {
      const Kernel<Real>* kernel = FindKernel<Real>(name);
      if (kernel == nullptr) continue;
      const auto add = [&](const std::string& what, void (Rope<Real>::*function)(), bool ground,
                           const Effect* effect = nullptr, int dashpot_stages = 1) {
        benchmark::RegisterBenchmark(
            fmt::format("{}/{}/{}/{}/{}", what, precision, name, nodes, springs).c_str(),
            Measure<Real>, function, Case{nodes, springs, ground, effect, dashpot_stages}, *kernel);
      };
      add("free", &Rope<Real>::Forward, false);
      add("forward", &Rope<Real>::Forward, true);
      add("gradient", &Rope<Real>::Gradient, true);
      add("forward_stages4", &Rope<Real>::Forward, true, nullptr, 4);
      add("gradient_stages4", &Rope<Real>::Gradient, true, nullptr, 4);
      for (const Effect* effect : EffectsAlongSprings()) {
        add("forward_" + effect->name(), &Rope<Real>::Forward, true, effect);
        add("gradient_" + effect->name(), &Rope<Real>::Gradient, true, effect);
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
