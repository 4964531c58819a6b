// SPDX-License-Identifier: Apache-2.0
// Effects along the springs against a plain simulation, one spring after the other, with the
// formula of each effect.
#include "twin/effects/spring_effect.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/support/targeted_rollout.h"

namespace physpring {
namespace {

using Vector = Eigen::Vector3d;

struct KnownEffect {
  EffectValues values;
  // Extra tension at time t, in a sub-step of h; z: internal variable.
  std::function<double(const SpringMoment<double>& s, double t, double h, double* z)> tension;
};

std::vector<KnownEffect> KnownEffects() {
  using Moment = SpringMoment<double>;
  const auto stretch = [](const Moment& s) { return s.length - s.rest_length; };
  return {
      {{"viscoelastic", Eigen::Vector2d(0.5, 0.02)},
       [=](const Moment& s, double, double h, double* z) {
         *z = (*z + h * s.rate) * std::exp(-h / 0.02);
         return 0.5 * s.stiffness * (*z - stretch(s));
       }},
      {{"yield", Eigen::Vector3d(2e-3, 0.1, 1e-3)},
       [=](const Moment& s, double, double, double* p) {
         const double y = 2e-3 + 0.1 * s.rest_length, seen = stretch(s) - 1e-3 * s.pull;
         *p = std::clamp(*p, seen - y, seen + y);
         return -s.stiffness * *p;
       }},
      {{"dry_friction", Eigen::Vector2d(0.01, 30)},
       [](const Moment& s, double, double h, double* z) {
         const double slip = 0.01 * s.rest_length;
         *z = std::clamp((*z + h * s.rate) * std::exp(-30 * h), -slip, slip);
         return s.stiffness * *z;
       }},
      {{"stiffness_drift", Eigen::VectorXd::Constant(1, 1.5)},
       [=](const Moment& s, double t, double, double*) {
         return 1.5 * t * s.stiffness * stretch(s);
       }},
      {{"tension_only", Eigen::VectorXd::Constant(1, 0.7)},
       [=](const Moment& s, double, double, double*) {
         return std::max(0.0, -0.7 * s.stiffness * stretch(s));
       }},
      {{"stiffening", Eigen::VectorXd::Constant(1, 30)},
       [=](const Moment& s, double, double, double*) {
         return 30 * s.stiffness * std::pow(stretch(s), 3) / (s.rest_length * s.rest_length);
       }},
  };
}

TargetedRollout RolloutWith(const std::vector<KnownEffect>& effects) {
  TargetedRollout rollout = RandomRollout(4, 1);
  for (std::size_t i = 0; i < rollout.frames.size(); ++i) {
    rollout.frames[i].time = static_cast<double>(i) * rollout.options.frame_time;
  }
  for (const KnownEffect& effect : effects) rollout.system.effects.push_back(effect.values);
  return rollout;
}

class PlainSimulation {
 public:
  PlainSimulation(const TargetedRollout& rollout, std::vector<KnownEffect> effects)
      : system_(rollout.system),
        effects_(std::move(effects)),
        h_(rollout.options.frame_time / rollout.options.substeps),
        gravity_(rollout.environment.gravity),
        x_(system_.position),
        v_(Points::Zero(3, x_.cols())),
        z_(Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(effects_.size()),
                                 system_.spring_count())) {
    x_.leftCols(system_.node_count()) = rollout.position;
    v_.leftCols(system_.node_count()) = rollout.velocity;
    for (const FrameInput& frame : rollout.frames) Advance(frame, rollout.options);
  }

  Points Positions() const { return x_.leftCols(system_.node_count()); }

 private:
  void Advance(const FrameInput& frame, const SimulationOptions& options) {
    const Points way = frame.controllers_end - frame.controllers_start;
    for (int i = 0; i < options.substeps; ++i) {
      x_.rightCols(system_.controllers) =
          frame.controllers_start + way * (i + 1) / options.substeps;
      v_.rightCols(system_.controllers) = way / options.frame_time;
      Substep(frame.time + i * h_);
    }
  }

  void Substep(double time) {
    Points force = Points::Zero(3, x_.cols());
    for (int e = 0; e < system_.spring_count(); ++e) {
      const auto [a, b] = system_.springs[e];
      const Vector d = x_.col(b) - x_.col(a), n = d.normalized();
      SpringMoment<double> s{d.norm(), n.dot(v_.col(b) - v_.col(a)), system_.stiffness[e],
                             system_.rest_length[e]};
      if (a >= system_.node_count()) s.pull -= n.dot(v_.col(a));
      if (b >= system_.node_count()) s.pull += n.dot(v_.col(b));
      double tension = s.stiffness * (s.length - s.rest_length) + system_.dashpot[e] * s.rate;
      for (std::size_t i = 0; i < effects_.size(); ++i) {
        tension += effects_[i].tension(s, time, h_, &z_(static_cast<Eigen::Index>(i), e));
      }
      force.col(a) += tension * n;
      force.col(b) -= tension * n;
    }
    for (int i = 0; i < system_.node_count(); ++i) {
      v_.col(i) += h_ * (force.col(i) / system_.mass[i] + gravity_);
      v_.col(i) *= std::exp(-h_ * system_.drag);
      x_.col(i) += h_ * v_.col(i);
    }
  }

  const SpringMassSystem system_;
  const std::vector<KnownEffect> effects_;
  const double h_;
  const Vector gravity_;
  Points x_, v_;
  Eigen::MatrixXd z_;  // effects x springs
};

// Largest difference of a coordinate, m, of about 0.2 m.
template <class Real>
double Difference(const std::vector<KnownEffect>& effects) {
  const TargetedRollout rollout = RolloutWith(effects);
  const Points plain = PlainSimulation(rollout, effects).Positions();
  return (Simulate<Real>(rollout).back() - plain).cwiseAbs().maxCoeff();
}

TEST(SpringEffect, FollowsItsFormula) {
  for (const KnownEffect& effect : KnownEffects()) {
    SCOPED_TRACE(effect.values.name);
    EXPECT_LT(Difference<double>({effect}), 1e-14);  // of 40 sub-steps, each rounded at 1e-17
    EXPECT_LT(Difference<float>({effect}), 1e-6);    // 1e-8
  }
}

TEST(SpringEffect, ActsTogetherWithOthers) {
  EXPECT_LT(Difference<double>(KnownEffects()), 1e-14);
  EXPECT_LT(Difference<float>(KnownEffects()), 1e-6);
}

// Kernels differ in how they measure springs; the laws are the same.
TEST(SpringEffect, GivesTheSameBitsWithAnyKernel) {
  const TargetedRollout rollout = RolloutWith(KnownEffects());
  const auto simulate = [&](const Kernel<float>& kernel) {
    const Simulator<float> simulator(rollout.system, {}, rollout.options, kernel);
    Simulator<float>::Workspace workspace(simulator);
    NodeStates<float> state = simulator.MakeState(rollout.position, rollout.velocity);
    NodeStates<float> bar = simulator.MakeState(rollout.target[0], rollout.velocity);
    SystemGradient gradient(rollout.system);
    simulator.RecordFrame(rollout.frames[0], &state, &workspace);
    simulator.RecordedFrameAdjoint(&bar, &gradient, &workspace);
    Eigen::VectorXd values(6);
    for (int i = 0; i < 6; ++i) values[i] = gradient.effects[i].sum();
    return std::tuple(simulator.Positions(state), simulator.Positions(bar), values);
  };
  for (std::string_view name : kKernelNames) {
    const Kernel<float>* kernel = FindKernel<float>(name);
    if (kernel == nullptr) continue;  // not on this processor
    EXPECT_EQ(simulate(*FindKernel<float>("scalar")), simulate(*kernel)) << name;
  }
}

}  // namespace
}  // namespace physpring
