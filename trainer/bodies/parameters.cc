// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/parameters.h"

#include <algorithm>
#include <cmath>

#include "trainer/bodies/contact_logits.h"
#include "trainer/bodies/hanging_net.h"

namespace physpring {
namespace {

std::vector<EffectValues> LastEffects(const SpringMassSystem& system, int count) {
  return {system.effects.end() - count, system.effects.end()};
}

}  // namespace

Parameters::Parameters(const SpringMassSystem& base, const ParameterOptions& options)
    : base_(base),
      options_(options),
      effects_(LastEffects(base, options.free_effects), options.moment_unit),
      springs_(base.spring_count()),
      classes_(options.length_classes ? ClassesOf(base, options.classes) : OneClass(base)),
      first_class_(options.contact ? kContact + kContactCount : kContact),
      modes_at_(first_class_ + (options.class_dashpots ? 2 : 1) * classes_.count),
      effects_at_(modes_at_ + mode_count()),
      size_(effects_at_ + effects_.size()) {
  if (options.stretch) stretch_ = size_++;
  const auto add = [this](bool wanted, int* offset) {
    if (!wanted) return;
    *offset = size_;
    size_ += springs_;
  };
  add(options.spring_stiffness, &stiffness_);
  add(options.spring_dashpot, &dashpot_);
  add(options.spring_rest_length, &rest_length_);
}

Parameters::Kind Parameters::kind(int i) const {
  const auto within = [&](int offset) {
    return offset >= 0 && i >= offset && i < offset + springs_;
  };
  if (within(stiffness_)) return Kind::kStiffness;
  if (within(dashpot_)) return Kind::kDashpot;
  if (within(rest_length_)) return Kind::kRestLength;
  if (i >= modes_at_ && i < effects_at_) return Kind::kMode;
  if (i >= first_class_ + classes_.count && i < modes_at_) return Kind::kClassDashpot;
  return Kind::kGlobal;
}

int Parameters::friction() const {
  if (!options_.contact) return -1;
  int entry = kContact;
  for (const auto& c : kContactCoefficients<double>) {
    if (c.member == &ContactPair<double>::friction) break;
    ++entry;
  }
  return entry;
}

double Parameters::LengthInBase(int e) const {
  const auto [a, b] = base_.springs[e];
  return (base_.position.col(a) - base_.position.col(b)).norm();
}

double Parameters::StrainInBase(int e) const {
  return StrainOfRatio(base_.rest_length[e] / LengthInBase(e));
}

std::vector<int> Parameters::WholeBodyEntries() const {
  std::vector<int> entries;
  for (int i = 0; i < first_class_; ++i) {
    const bool dashpot = i == kDashpot || i == kControllerDashpot;
    if (!dashpot || options_.dashpots) entries.push_back(i);
  }
  for (int i = 0; i < effect_count(); ++i) {
    if (!effects_.is_of_several(i)) entries.push_back(effects_at_ + i);
  }
  if (stretch_ >= 0) entries.push_back(stretch_);
  return entries;
}

std::vector<int> Parameters::AlongBodyEntries() const {
  std::vector<int> entries;
  for (int i = 0; i < effect_count(); ++i) {
    if (effects_.is_of_several(i)) entries.push_back(effects_at_ + i);
  }
  return entries;
}

SpringMassSystem Parameters::Apply(const Eigen::VectorXd& values) const {
  SpringMassSystem system = base_;
  Eigen::VectorXd field = Eigen::VectorXd::Zero(springs_);
  if (mode_count() > 0) field = options_.modes * values.segment(modes_at_, mode_count());
  for (int e = 0; e < springs_; ++e) {
    const bool hand = base_.IsControllerSpring(e);
    const double own_stiffness = stiffness_ < 0 ? 0 : values[stiffness_ + e];
    const double own_dashpot = dashpot_ < 0 ? 0 : values[dashpot_ + e];
    const double stiffness = values[hand ? kControllerStiffness : kStiffness] +
                             values[ClassStiffness(e)] + field[e] + own_stiffness;
    const int class_dashpot = ClassDashpot(e);
    const double dashpot = values[hand ? kControllerDashpot : kDashpot] +
                           (class_dashpot < 0 ? 0 : values[class_dashpot]) + own_dashpot;
    system.stiffness[e] *= std::exp(stiffness);
    if (options_.dashpots) {
      system.dashpot[e] *= std::exp(options_.loss_times ? stiffness + dashpot : dashpot);
    }
    if (stretch_ >= 0) {
      system.rest_length[e] =
          LengthInBase(e) * RestRatio(StrainInBase(e) * std::exp(values[stretch_]));
    }
    if (rest_length_ >= 0) system.rest_length[e] *= std::exp(values[rest_length_ + e]);
  }
  system.drag *= std::exp(values[kDrag]);
  if (options_.contact) {
    MoveLogits(values.segment<kContactCount>(kContact), &system.contact.surface);
  }
  const std::vector<EffectValues> moved =
      effects_.Apply(values.segment(effects_at_, effects_.size()));
  std::copy(moved.begin(), moved.end(), system.effects.end() - options_.free_effects);
  return system;
}

Eigen::VectorXd Parameters::Adjoint(const Eigen::VectorXd& values, const SpringMassSystem& system,
                                    const SystemGradient& gradient) const {
  Eigen::VectorXd bar = Eigen::VectorXd::Zero(size_);
  // forward: y = base exp(sum), so y_bar y is the derivative with respect to each
  Eigen::VectorXd dashpots_bar = gradient.dashpot.cwiseProduct(system.dashpot);
  if (!options_.dashpots) dashpots_bar.setZero();
  Eigen::VectorXd stiffnesses_bar = gradient.stiffness.cwiseProduct(system.stiffness);
  if (options_.loss_times) stiffnesses_bar += dashpots_bar;
  if (mode_count() > 0) {
    bar.segment(modes_at_, mode_count()) = options_.modes.transpose() * stiffnesses_bar;
  }
  for (int e = 0; e < springs_; ++e) {
    const bool hand = base_.IsControllerSpring(e);
    const double stiffness_bar = stiffnesses_bar[e], dashpot_bar = dashpots_bar[e];
    bar[hand ? kControllerStiffness : kStiffness] += stiffness_bar;
    bar[hand ? kControllerDashpot : kDashpot] += dashpot_bar;
    bar[ClassStiffness(e)] += stiffness_bar;
    if (const int i = ClassDashpot(e); i >= 0) bar[i] += dashpot_bar;
    if (stiffness_ >= 0) bar[stiffness_ + e] = stiffness_bar;
    if (dashpot_ >= 0) bar[dashpot_ + e] = dashpot_bar;
    const double rest_length_bar = gradient.rest_length[e] * system.rest_length[e];
    if (stretch_ >= 0) {
      const double strain = StrainInBase(e) * std::exp(values[stretch_]);
      bar[stretch_] += rest_length_bar * strain * RestRatioSlope(strain) / RestRatio(strain);
    }
    if (rest_length_ >= 0) bar[rest_length_ + e] = rest_length_bar;
  }
  bar[kDrag] = gradient.drag * system.drag;
  if (options_.contact) {
    bar.segment<kContactCount>(kContact) =
        MoveLogitsAdjoint(system.contact.surface, gradient.contact.surface);
  }
  bar.segment(effects_at_, effects_.size()) =
      effects_.Adjoint(values.segment(effects_at_, effects_.size()),
                       {gradient.effects.end() - options_.free_effects, gradient.effects.end()});
  return bar;
}

}  // namespace physpring
