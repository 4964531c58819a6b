// SPDX-License-Identifier: Apache-2.0
#include "twin/lane_step.h"

#include <algorithm>
#include <cassert>

namespace physpring {

template <class Real>
LaneStep<Real>::LaneStep(const std::vector<const LevelStep<Real>*>& levels,
                         const std::vector<NodeView<Real>>& nodes, const LaneKernel<Real>& kernel)
    : levels_(levels),
      kernel_(kernel),
      nodes_(nodes[0].nodes),
      springs_(level().springs().size()),
      h_(nodes[0].h),
      needs_nodes_(level().effects().has_node_forces() ||
                   level().effects().tensions().needs_nodes()),
      h_over_mass_(nodes_, kernel.lanes),
      decay_(1, kernel.lanes),
      kick_(3, kernel.lanes),
      parameters_(kLaneSpring * springs_, kernel.lanes),
      radius_(nodes_, kernel.lanes),
      restitution_(1, kernel.lanes),
      friction_(1, kernel.lanes),
      pyramidal_(1, kernel.lanes),
      force_(kLaneForce * level().first_internal(), kernel.lanes),
      length_(springs_, kernel.lanes),
      rate_(springs_, kernel.lanes),
      tension_(springs_, kernel.lanes),
      direction_(Staged(3 * springs_), kernel.lanes),
      velocity_(Staged(kLaneForce * level().first_internal()), kernel.lanes),
      staged_(Staged(kLaneForce * level().first_internal()), kernel.lanes),
      before_(Staged(kLaneForce * level().first_internal()), kernel.lanes),
      effect_(before_),
      after_(before_),
      effects_(levels.size()),
      impacts_(levels.size()),
      own_(kernel.lanes, nullptr),
      rows_(kernel.lanes, nullptr),
      spare_(std::max(kLaneState * level().first_internal(), springs_)) {
  assert(levels.size() <= static_cast<std::size_t>(kernel.lanes) && levels.size() == nodes.size());
  SetParameters(nodes);
}

template <class Real>
void LaneStep<Real>::SetParameters(const std::vector<NodeView<Real>>& nodes) {
  const int lanes = kernel_.lanes;
  for (std::size_t n = 0; n < levels_.size(); ++n) {
    const int lane = static_cast<int>(n);
    const SpringBlocks<Real>& springs = levels_[n]->springs();
    assert(springs.a == level().springs().a && springs.b == level().springs().b);
    for (int i = 0; i < springs_; ++i) {
      Real* spring = parameters_.data() + kLaneSpring * lanes * i + lane;
      spring[0] = springs.stiffness[i];
      spring[lanes] = springs.rest_length[i];
      spring[2 * lanes] = springs.dashpot[i];
    }
    for (int i = 0; i < nodes_; ++i) {
      h_over_mass_.data()[lanes * i + lane] = nodes[n].h_over_mass[i];
      radius_.data()[lanes * i + lane] = levels_[n]->contact().radius()[i];
    }
    const ContactPair<Real>& law = levels_[n]->contact().surface_law();
    restitution_.data()[lane] = law.restitution;
    friction_.data()[lane] = law.friction;
    pyramidal_.data()[lane] = law.cone == FrictionCone::kPyramidal;
    decay_.data()[lane] = nodes[n].decay;
    for (int j = 0; j < 3; ++j) kick_.data()[lanes * j + lane] = nodes[n].kick.f[j];
  }
}

template <class Real>
void LaneStep<Real>::Interleave(const std::vector<State*>& states, int first, int count,
                                Real* side_by_side) {
  std::fill(spare_.begin(), spare_.end(), Real(0));
  for (int l = 0; l < kernel_.lanes; ++l) {
    rows_[l] = states[l] != nullptr ? Internal(states[l], first) : spare_.data();
  }
  kernel_.interleave(rows_.data(), kLaneState * count,
                     side_by_side + kLaneState * kernel_.lanes * first);
}

template <class Real>
void LaneStep<Real>::Separate(const Real* side_by_side, int first, int count,
                              const std::vector<State*>& states) {
  for (int l = 0; l < kernel_.lanes; ++l) {
    rows_[l] = states[l] != nullptr ? Internal(states[l], first) : spare_.data();
  }
  kernel_.separate(side_by_side + kLaneState * kernel_.lanes * first, kLaneState * count,
                   rows_.data());
}

template <class Real>
void LaneStep<Real>::SeparateNodes(const Lanes& lanes, const Real* side_by_side,
                                   State* LaneNow<Real>::*of) {
  std::fill(own_.begin(), own_.end(), nullptr);
  for (const LaneNow<Real>& one : lanes) own_[one.lane] = one.*of;
  Separate(side_by_side, 0, nodes_, own_);
}

template <class Real>
void LaneStep<Real>::Advance(const Lanes& lanes, const Real* state, Real* next) {
  if (needs_nodes_) SeparateNodes(lanes, state, &LaneNow<Real>::state);
  const SpringView<Real> view = level().springs().View();
  LaneSprings<Real> springs{view.blocks, view.a, view.b, parameters_.data()};
  if (level().effects().tensions().along()) springs.tension = AddTensions(lanes, state);
  if (HasStages()) springs.direction = direction_.data();
  force_.Clear();
  kernel_.add_spring_forces(springs, state, force_.data());
  if (level().effects().has_node_forces()) AddNodeForces(lanes);
  if (HasStages()) ApplyDashpotStages(springs);
  kernel_.update_velocities(Nodes(), state, force_.data(), next);
  ApplyContacts(lanes, state, next);
  kernel_.update_positions(Nodes(), state, next);
}

template <class Real>
const Real* LaneStep<Real>::AddTensions(const Lanes& lanes, const Real* state) {
  const SpringView<Real> view = level().springs().View();
  kernel_.measure_springs({view.blocks, view.a, view.b, parameters_.data()}, state, length_.data(),
                          rate_.data());
  std::fill(rows_.begin(), rows_.end(), spare_.data());
  for (const LaneNow<Real>& one : lanes) {
    const TensionStep<Real>& tensions = levels_[one.lane]->effects().tensions();
    rows_[one.lane] = tensions.Measures(&effects_[one.lane].tension).length;
  }
  kernel_.separate(length_.data(), springs_, rows_.data());
  for (const LaneNow<Real>& one : lanes) rows_[one.lane] = effects_[one.lane].tension.rate.data();
  kernel_.separate(rate_.data(), springs_, rows_.data());
  for (const LaneNow<Real>& one : lanes) {
    const LevelStep<Real>& level = *levels_[one.lane];
    EffectBuffers<Real>& buffers = effects_[one.lane];
    level.effects().tensions().AddTensions(level.EffectsOf(one.now, *one.state), one.next,
                                           &buffers.tension);
    rows_[one.lane] = buffers.tension.tension.data();
  }
  kernel_.interleave(rows_.data(), springs_, tension_.data());
  return tension_.data();
}

template <class Real>
void LaneStep<Real>::AddNodeForces(const Lanes& lanes) {
  for (const LaneNow<Real>& one : lanes) {
    const LevelStep<Real>& level = *levels_[one.lane];
    EffectBuffers<Real>& buffers = effects_[one.lane];
    level.effects().ComputeNodeForces(level.EffectsOf(one.now, *one.state), one.next, &buffers);
    const double* added = buffers.force.data();
    Real* force = force_.data() + one.lane;
    for (int i = 0; i < 3 * nodes_; ++i) force[kernel_.lanes * i] += static_cast<Real>(added[i]);
  }
}

template <class Real>
void LaneStep<Real>::ApplyDashpotStages(const LaneSprings<Real>& springs) {
  const DashpotStages<Real>& stages = level().dashpot_stages();
  for (LaneArray<Real>* zero : {&before_, &effect_, &staged_}) zero->Clear();
  for (int j = 0; j < stages.count(); ++j) {
    if (j > 0) {
      kernel_.add_dashpot_forces(springs, velocity_.data(), staged_.data());
    }
    kernel_.advance_stage(Nodes(),
                          {stages.stage(j), level().first_internal(), force_.data(), staged_.data(),
                           before_.data(), effect_.data(), after_.data(), velocity_.data()});
    std::swap(before_, effect_);
    std::swap(effect_, after_);
  }
  std::swap(force_, effect_);
}

template <class Real>
void LaneStep<Real>::ApplyContacts(const Lanes& lanes, const Real* state, Real* next) {
  const bool only_ground = std::all_of(lanes.begin(), lanes.end(), [](const LaneNow<Real>& one) {
    return one.now.pairs.empty() && one.now.geoms.empty();
  });
  if (!only_ground) {
    ApplyAllContacts(lanes, state, next);
  } else if (level().contact().has_ground()) {
    HitGround(state, next);
  }
}

template <class Real>
void LaneStep<Real>::ApplyAllContacts(const Lanes& lanes, const Real* state, Real* next) {
  if (!needs_nodes_) SeparateNodes(lanes, state, &LaneNow<Real>::state);
  SeparateNodes(lanes, next, &LaneNow<Real>::next);
  for (const auto& [lane, now, own_state, own_next] : lanes) {
    levels_[lane]->contact().Apply(*own_state, now.pairs, now.geoms, now.elapsed, now.h, own_next,
                                   &impacts_[lane]);
  }
  Interleave(own_, 0, nodes_, next);
}

template <class Real>
void LaneStep<Real>::HitGround(const Real* state, Real* next) const {
  const Contact<Real>& contact = level().contact();
  const auto& n = contact.ground_normal();
  const auto &first = contact.ground_tangents().first, &second = contact.ground_tangents().second;
  kernel_.hit_ground(Nodes(),
                     {{n[0], n[1], n[2]},
                      {{first[0], first[1], first[2]}, {second[0], second[1], second[2]}},
                      contact.ground_offset(),
                      radius_.data(),
                      static_cast<Real>(kApproach),
                      static_cast<Real>(kSliding),
                      restitution_.data(),
                      friction_.data(),
                      pyramidal_.data()},
                     state, next);
}

template class LaneStep<float>;
template class LaneStep<double>;

}  // namespace physpring
