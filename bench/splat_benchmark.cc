// SPDX-License-Identifier: Apache-2.0
// A picture of 640 x 480 pixels of splats, projected and drawn, on one thread and on two. The
// splats lie on the shell of a ball that fills the picture's height: so many that a pixel sees
// through many layers, each about 2 pixels wide.
#include <benchmark/benchmark.h>

#include <numbers>
#include <random>

#include "splats/rasterise.h"
#include "twin/uniform.h"

namespace physpring {
namespace {

constexpr int kWidth = 640, kHeight = 480;

Splats Ball(int count, int degree) {
  std::mt19937_64 random(1);
  const auto between = [&](double from, double to) {
    return static_cast<float>(from + (to - from) * Uniform(&random));
  };
  Splats splats;
  splats.Resize(count, degree);
  // as large as their distance on the ball, two thirds of it across
  const double gap = std::sqrt(4 * std::numbers::pi / count);
  for (int i = 0; i < count; ++i) {
    Eigen::Vector3f p(between(-1, 1), between(-1, 1), between(-1, 1));
    while (p.norm() > 1 || p.norm() < 0.1F) p = {between(-1, 1), between(-1, 1), between(-1, 1)};
    splats.position.col(i) = p.normalized();
    for (int axis = 0; axis < 3; ++axis) {
      splats.log_scale(axis, i) = static_cast<float>(std::log(gap * between(0.3, 0.7)));
    }
    splats.rotation.col(i) << 1, between(-1, 1), between(-1, 1), between(-1, 1);
    splats.logit[i] = between(-1, 4);
    for (float& x : splats.harmonics.col(i)) x = between(-0.4, 0.4);
  }
  return splats;
}

void Draw(benchmark::State& state) {
  const Splats splats = Ball(static_cast<int>(state.range(0)), static_cast<int>(state.range(2)));
  const PlacedSplats placed = AsStored(splats);
  PinholeCamera camera{kWidth, kHeight};
  camera.shift = {0, 0, 2.4};
  camera.fx = camera.fy = kHeight;
  camera.cx = kWidth / 2.0;
  camera.cy = kHeight / 2.0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        Rasterise(placed, camera, {}, static_cast<int>(state.range(1))).rgb.data());
  }
}
BENCHMARK(Draw)
    ->ArgNames({"count", "threads", "degree"})
    ->ArgsProduct({{10000, 100000}, {1, 2}, {0, 3}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace physpring

BENCHMARK_MAIN();
