// SPDX-License-Identifier: Apache-2.0
// Times the sub-step of a twin's level 0 and prints one line of JSON, for compare_with_warp.py:
//   time_twin NAME.twin.npz --substeps 667 --precision float
// The twin starts at rest in its reference position on the ground z = 0. One frame of `substeps`
// sub-steps forward; and forward with its adjoint, for loss = sum of |x - x(0)|^2 at its end. Times
// are CPU time.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>
#include <vector>

#include "twin/error.h"
#include "twin/simulator.h"
#include "twin/twin.h"

namespace physpring {
namespace {

struct Options {
  std::string twin;
  std::string precision = "float";
  int substeps = 667;
  int repeats = 5;
};

// Median CPU time of a call, us.
template <class Function>
double TimeOf(const Function& function, int repeats) {
  function();  // touches the memory
  std::vector<double> times;
  for (int i = 0; i < repeats; ++i) {
    const std::clock_t start = std::clock();
    function();
    times.push_back(static_cast<double>(std::clock() - start) * (1e6 / CLOCKS_PER_SEC));
  }
  std::nth_element(times.begin(), times.begin() + repeats / 2, times.end());
  return times[repeats / 2];
}

template <class Real>
void Report(const Options& options) {
  const Twin twin = ReadTwin(options.twin);
  const TwinLevel& level = twin.levels.front();
  const SpringMassSystem& system = level.system;
  if (system.controllers > 0) throw Error(options.twin + ": has controllers; expected none");
  const double frame_time = static_cast<double>(options.substeps) / level.substeps_per_second;
  const Simulator<Real> simulator(system, {twin.gravity, Eigen::Vector4d(0, 0, 1, 0)},
                                  {.frame_time = frame_time, .substeps = options.substeps});
  typename Simulator<Real>::Workspace workspace(simulator);
  const FrameInput input{Points(3, 0), Points(3, 0), {}};
  const Points still = Points::Zero(3, system.node_count());
  const NodeStates<Real> start = simulator.MakeState(system.position, still);

  NodeStates<Real> state;
  const auto forward = [&] {
    state = start;
    simulator.AdvanceFrame(input, &state, &workspace);
  };
  double loss = 0;
  SystemGradient gradient(system);
  const auto with_gradient = [&] {
    state = start;
    simulator.RecordFrame(input, &state, &workspace);
    const Points change = simulator.Positions(state) - system.position;
    loss = change.squaredNorm();
    NodeStates<Real> state_bar = simulator.MakeState(2 * change, still);
    simulator.RecordedFrameAdjoint(&state_bar, &gradient, &workspace);
  };
  const double forward_time = TimeOf(forward, options.repeats) / options.substeps;
  const double gradient_time = TimeOf(with_gradient, options.repeats) / options.substeps;
  fmt::print(
      "{{\"program\": \"physpring {} {}\", \"precision\": \"{}\", \"nodes\": {}, \"springs\": {}, "
      "\"substeps\": {}, \"us_per_substep_forward\": {}, \"us_per_substep_gradient\": {}, "
      "\"loss\": {}}}\n",
      PHYSPRING_VERSION, BestKernel<Real>().name, options.precision, system.node_count(),
      system.spring_count(), options.substeps, forward_time, gradient_time, loss);
}

}  // namespace
}  // namespace physpring

int main(int argc, char** argv) {
  physpring::Options options;
  CLI::App app("Times the sub-step of a twin's level 0 on the ground z = 0");
  app.add_option("twin", options.twin, "NAME.twin.npz, without controllers")->required();
  app.add_option("--substeps", options.substeps, "of the frame")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--precision", options.precision)
      ->check(CLI::IsMember({"float", "double"}))
      ->capture_default_str();
  app.add_option("--repeats", options.repeats, "median of so many")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    options.precision == "float" ? physpring::Report<float>(options)
                                 : physpring::Report<double>(options);
  } catch (const physpring::Error& error) {
    fmt::print(stderr, "time_twin: {}\n", error.what());
    return 1;
  }
}
