// SPDX-License-Identifier: Apache-2.0
#include "plugin/contact.h"

#include <algorithm>

#include "plugin/euler_step.h"
#include "twin/attribute_names.h"

namespace physpring {

namespace {

using Vector = Eigen::Vector3d;

Level ReadLevelWithJoinedPairs(const mjModel* model, int instance) {
  const Attributes attributes(model, instance);
  Level level = ReadLevel(model, instance, attributes);
  CheckOptions(model, level, attributes.where());
  ReadJoinedPairs(attributes, &level);
  return level;
}

}  // namespace

LevelContactModel::LevelContactModel(const mjModel* model, int instance)
    : level(ReadLevelWithJoinedPairs(model, instance)),
      particles(level.system, {Vector::Zero(), {}}) {}

const std::vector<const char*>& LevelContact::AttributeNames() {
  static const std::vector<const char*> names =
      WithLevelNumbers({kAttrNodes, kAttrSprings, kAttrCone},
                       {NumberRole::kSurface, NumberRole::kObject, NumberRole::kReach});
  return names;
}

LevelContact::LevelContact(const mjModel* model, int instance)
    : contact_(std::make_shared<LevelContactModel>(model, instance)),
      surfaces_(model, instance, contact_->level),
      state_(contact_->level.dofs.size()),
      next_(state_.size()) {
  CheckStateSize(model, instance, surfaces_.state_size(), Attributes(model, instance).where());
}

void LevelContact::Compute(const mjModel* model, mjData* data, int instance) {
  const Level& level = contact_->level;
  const EulerStep step(model);
  for (std::size_t i = 0; i < state_.size(); ++i) {
    const double* x = data->xpos + 3 * level.bodies.nodes[i];
    std::copy(x, x + 3, state_[i].x);
    const double mass = level.system.mass[static_cast<Eigen::Index>(i)];
    Eigen::Map<Vector>(state_[i].v) = step.NextVelocity(data, level.dofs[i], level.joints[i], mass);
  }
  next_ = state_;
  const double time = step.time();
  surfaces_.Collect(model, data, state_, data->plugin_state + model->plugin_stateadr[instance]);
  const auto pairs = contact_->particles.FindPairs(state_, time);
  contact_->particles.Apply(state_, pairs, {}, 0, time, &next_, &impacts_);
  surfaces_.Apply(state_, time, &next_);
  for (std::size_t i = 0; i < state_.size(); ++i) {
    const Vector change =
        Eigen::Map<const Vector>(next_[i].v) - Eigen::Map<const Vector>(state_[i].v);
    const double mass = level.system.mass[static_cast<Eigen::Index>(i)];
    if (!change.isZero(0)) step.AddChange(change, level.dofs[i], level.joints[i], mass, data);
  }
  surfaces_.AddReactions(model, data, time);
}

}  // namespace physpring
