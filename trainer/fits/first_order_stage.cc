// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/first_order_stage.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "trainer/bodies/phystwin_variables.h"
#include "trainer/motion/frame_walk.h"
#include "twin/parallel.h"

namespace physpring {
namespace {

constexpr double kRate = 1e-3;
constexpr double kAdamEpsilon = 1e-8;  // the default of PhysTwin's optimiser
constexpr int kSelectEvery = 20;       // passes
constexpr double kLeastY = 1e-3;       // N, so that ln Y exists
constexpr int kCoefficients = 2 * kContactCount;

// Coefficient i of contact, in the order of the values: the ground's, then the particles'.
template <class Contact>
auto& CoefficientOf(Contact& contact, int i) {
  const auto member = kContactCoefficients<double>[i % kContactCount].member;
  return i < kContactCount ? contact.surface.*member : contact.object.*member;
}
double Largest(int i) { return kContactCoefficients<double>[i % kContactCount].most; }

// One recording on its way through a pass.
struct Walker {
  std::unique_ptr<FrameWalk> walk;
  int frames;
  std::optional<double> loss;  // of the frame
  SystemGradient gradient;     // of that loss
};

}  // namespace

FirstOrderStage::FirstOrderStage(const SpringMassSystem& start, int most_passes)
    : start_(start),
      most_passes_(most_passes),
      mass_(start.mass[0]),
      values_(start.spring_count() + kCoefficients),
      adam_(values_.size()) {
  const int springs = start.spring_count();
  for (int e = 0; e < springs; ++e) {
    values_[e] = std::log(std::max(kLeastY, start.stiffness[e] * start.rest_length[e] / mass_));
  }
  for (int i = 0; i < kCoefficients; ++i) values_[springs + i] = CoefficientOf(start.contact, i);
  adam_.epsilon = kAdamEpsilon;
  best_ = values_;
}

SpringMassSystem FirstOrderStage::With(const Eigen::VectorXd& values) const {
  SpringMassSystem system = start_;
  const int springs = system.spring_count();
  for (int e = 0; e < springs; ++e) {
    const double y = std::min(std::exp(values[e]), kPhysTwinLargestY);
    system.stiffness[e] = y * mass_ / system.rest_length[e];
  }
  for (int i = 0; i < kCoefficients; ++i) {
    CoefficientOf(system.contact, i) = std::clamp(values[springs + i], 0.0, Largest(i));
  }
  return system;
}

Eigen::VectorXd FirstOrderStage::Derivatives(const SystemGradient& gradient) const {
  Eigen::VectorXd bar(values_.size());
  const int springs = start_.spring_count();
  for (int e = 0; e < springs; ++e) {
    // forward: k = exp(value) m / L, clamped
    const double y = std::exp(values_[e]);
    bar[e] = y < kPhysTwinLargestY ? gradient.stiffness[e] * y * mass_ / start_.rest_length[e] : 0;
  }
  for (int i = 0; i < kCoefficients; ++i) {
    // forward: clamped to [0, largest]
    const double value = values_[springs + i];
    bar[springs + i] = value >= 0 && value <= Largest(i) ? CoefficientOf(gradient.contact, i) : 0;
  }
  return bar;
}

void FirstOrderStage::Pass(const std::vector<Recording>& recordings, const RolloutOptions& options,
                           int threads) {
  SpringMassSystem system = Current();
  const SystemGradient zero(system);
  std::vector<Walker> walkers;
  int most_frames = 0, frames = 0;
  for (const Recording& recording : recordings) {
    walkers.push_back(
        {StartWalk(system, recording, options, LossOptions()), recording.train_frames, {}, zero});
    most_frames = std::max(most_frames, recording.train_frames);
    frames += recording.train_frames - 1;
  }
  const Eigen::VectorXd rate = Eigen::VectorXd::Constant(values_.size(), kRate);
  double loss = 0;
  for (int frame = 1; frame < most_frames; ++frame) {
    ParallelFor(static_cast<int>(walkers.size()), threads, [&](int i) {
      Walker& walker = walkers[i];
      if (frame >= walker.frames) return;
      walker.gradient = zero;
      walker.loss = walker.walk->Step(system, &walker.gradient);
    });
    SystemGradient sum = zero;
    int walking = 0;
    for (const Walker& walker : walkers) {
      if (frame >= walker.frames) continue;
      if (!walker.loss) {
        diverged_ = true;
        return;
      }
      loss += *walker.loss;
      sum += walker.gradient;
      ++walking;
    }
    adam_.Step(Derivatives(sum) / walking, rate, &values_);
    system = Current();
  }

  last_loss_ = loss / frames;
  const bool looked_at = passes_ % kSelectEvery == 0 || passes_ + 1 == most_passes_;
  ++passes_;
  if (looked_at && last_loss_ < best_loss_) {
    best_ = values_;
    best_loss_ = last_loss_;
  }
}

}  // namespace physpring
