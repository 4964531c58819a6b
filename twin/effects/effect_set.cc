// SPDX-License-Identifier: Apache-2.0
#include "twin/effects/effect_set.h"

#include <algorithm>

#include "twin/effects/registry.h"

namespace physpring {

Setting ApplyEffects(const SpringMassSystem& system, const Eigen::Vector3d& gravity) {
  Setting setting{system, gravity};
  for (const EffectValues& effect : system.effects) {
    GetEffect(effect.name).Change(effect.values, &setting);
  }
  return setting;
}

double ControllerDelay(const SpringMassSystem& system) {
  double delay = 0;
  for (const EffectValues& effect : system.effects) {
    if (GetEffect(effect.name).delays()) delay += effect.values[0];
  }
  return delay;
}

SpringMassSystem BoundingSystem(const SpringMassSystem& system) {
  SpringMassSystem bound = ApplyEffects(system, Eigen::Vector3d::Zero()).system;
  for (const EffectValues& effect : system.effects) {
    GetEffect(effect.name).Stiffen(effect.values, &bound);
  }
  bound.effects.clear();
  return bound;
}

EffectSet::EffectSet(const SpringMassSystem& system, const Eigen::Vector3d& gravity)
    : settings_{{system, gravity}}, offset_{0} {
  for (const EffectValues& effect : system.effects) {
    effects_.push_back(&GetEffect(effect.name));
    settings_.push_back(settings_.back());
    effects_.back()->Change(effect.values, &settings_.back());
  }
  for (std::size_t i = 0; i < effects_.size(); ++i) {
    forces_.push_back(effects_[i]->MakeForce(changed().system, system.effects[i].values));
    bends_.push_back(effects_[i]->MakeBend(changed().system, system.effects[i].values));
    int end = offset_.back() + (forces_[i] ? forces_[i]->internal_size() : 0);
    if (bends_[i]) {
      bend_laws_.push_back({bends_[i].get(), end});
      end += bends_[i]->internal_size();
    }
    offset_.push_back(end);
  }
}

bool EffectSet::has_forces() const {
  return !bend_laws_.empty() || std::any_of(forces_.begin(), forces_.end(),
                                            [](const auto& force) { return force != nullptr; });
}

void EffectSet::AddForces(const Instant& instant, Eigen::VectorXd* internal, Points* force) const {
  for (std::size_t i = 0; i < forces_.size(); ++i) {
    if (!forces_[i]) continue;
    forces_[i]->Add(instant, internal->segment(offset_[i], forces_[i]->internal_size()), force);
  }
  if (!bend_laws_.empty()) AddBendForces(bend_laws_, instant, *internal, force);
}

void EffectSet::AddForcesAdjoint(const Instant& instant, const Eigen::VectorXd& internal,
                                 const Points& force_bar, Eigen::VectorXd* internal_bar,
                                 Points* x_bar, Points* v_bar, SystemGradient* gradient) const {
  InstantGradient sum{
      Points::Zero(3, instant.x.cols()), Points::Zero(3, instant.x.cols()), {}, gradient};
  for (std::size_t i = 0; i < forces_.size(); ++i) {
    if (!forces_[i]) continue;
    const int size = forces_[i]->internal_size();
    sum.values.setZero(gradient->effects[i].size());
    forces_[i]->AddAdjoint(instant, internal.segment(offset_[i], size), force_bar,
                           internal_bar->segment(offset_[i], size), &sum);
    gradient->effects[i] += sum.values;
  }
  if (!bend_laws_.empty()) {
    std::vector<Eigen::VectorXd*> values_bar;
    for (std::size_t i = 0; i < bends_.size(); ++i) {
      if (bends_[i]) values_bar.push_back(&gradient->effects[i]);
    }
    AddBendForcesAdjoint(bend_laws_, instant, internal, force_bar, *internal_bar, &sum.x, &sum.v,
                         values_bar);
  }
  *x_bar += sum.x;
  *v_bar += sum.v;
}

void EffectSet::ChangeAdjoint(double delay_bar, SystemGradient* gradient) const {
  for (std::size_t i = effects_.size(); i-- > 0;) {
    effects_[i]->ChangeAdjoint(settings_[0].system.effects[i].values, settings_[i], gradient,
                               &gradient->effects[i]);
    if (effects_[i]->delays()) gradient->effects[i][0] += delay_bar;
  }
}

}  // namespace physpring
