// SPDX-License-Identifier: Apache-2.0
#include "tracker/tracker_bank.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

namespace physpring {
namespace {

constexpr std::array<double, 4> kModelErrors = {0.05, 0.25, 1.2, 6};  // in the noise
constexpr std::size_t kFirst = 1;  // the best as long as nothing is known
constexpr double kMemory = 0.5;    // s, in which what was measured fades

}  // namespace

TrackerBank::TrackerBank(const SpringMassSystem& system, const Environment& environment,
                         const SimulationOptions& simulation, double noise, int surface,
                         const Points& nodes, const Points& velocity)
    : fps_(1 / simulation.frame_time),
      simulators_(std::make_unique<SideBySide>(system, environment, simulation,
                                               static_cast<int>(kModelErrors.size()))),
      surprise_(kModelErrors.size(), 0),
      best_(kFirst) {
  const auto correction = std::make_shared<const SmoothCorrection>(system);
  for (double error : kModelErrors) {
    trackers_.emplace_back(simulators_->simulator(), correction,
                           TrackerOptions{noise, error, surface}, nodes, velocity);
  }
}

void TrackerBank::Advance(FrameInput input, const FrameMeasurement& measured) {
  if (input.attached.any()) input.attached.nodes = best().position();
  std::vector<NodeStates<double>*> states;
  for (StateTracker& tracker : trackers_) states.push_back(tracker.state());
  simulators_->AdvanceFrame(input, states);
  const double fade = std::exp(-1 / (kMemory * fps_));
  for (std::size_t i = 0; i < trackers_.size(); ++i) {
    trackers_[i].Correct(measured);
    const double now = trackers_[i].surprise();
    const bool diverged = !trackers_[i].position().allFinite();
    if (std::isfinite(now) || diverged) {  // else nothing was ever measured
      surprise_[i] = fade * surprise_[i] + (1 - fade) * now * now;
    }
  }
  const auto least = std::min_element(surprise_.begin(), surprise_.end());
  if (*least > 0 && std::isfinite(*least))
    best_ = static_cast<std::size_t>(least - surprise_.begin());
}

}  // namespace physpring
