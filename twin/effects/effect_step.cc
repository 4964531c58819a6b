// SPDX-License-Identifier: Apache-2.0
#include "twin/effects/effect_step.h"

namespace physpring {
namespace {

// The internal variables in the records from `first` on.
template <class Real>
void UnpackInternal(const NodeStates<Real>& state, int first, Eigen::VectorXd* internal) {
  for (Eigen::Index i = 0; i < internal->size(); ++i) {
    const NodeState<Real>& record = state[static_cast<std::size_t>(first + i / 6)];
    const Eigen::Index entry = i % 6;
    (*internal)[i] = static_cast<double>(entry < 3 ? record.x[entry] : record.v[entry - 3]);
  }
}

template <class Real>
void PackInternal(const Eigen::VectorXd& internal, int first, NodeStates<Real>* state) {
  for (Eigen::Index i = 0; i < internal.size(); ++i) {
    NodeState<Real>& record = (*state)[static_cast<std::size_t>(first + i / 6)];
    const Eigen::Index entry = i % 6;
    (entry < 3 ? record.x[entry] : record.v[entry - 3]) = static_cast<Real>(internal[i]);
  }
}

}  // namespace

template <class Real>
void EffectStep<Real>::Unpack(const State& state, EffectBuffers* buffers) const {
  buffers->x.resize(3, columns_);
  buffers->v.resize(3, columns_);
  double *x = buffers->x.data(), *v = buffers->v.data();
  for (int i = 0; i < columns_; ++i) {
    for (int j = 0; j < 3; ++j) {
      x[3 * i + j] = static_cast<double>(state[i].x[j]);
      v[3 * i + j] = static_cast<double>(state[i].v[j]);
    }
  }
  buffers->internal.resize(effects_.internal_size());
  UnpackInternal(state, columns_ + 1, &buffers->internal);
}

template <class Real>
void EffectStep<Real>::AddForces(double time, double step, const State& state, State* next,
                                 NodeForces<Real>* force, EffectBuffers* buffers) const {
  Unpack(state, buffers);
  buffers->force.setZero(3, columns_);
  effects_.AddForces({time, step, buffers->x, buffers->v}, &buffers->internal, &buffers->force);
  const double* added = buffers->force.data();
  for (int i = 0; i < nodes_; ++i) {
    for (int j = 0; j < 3; ++j) (*force)[i].f[j] += static_cast<Real>(added[3 * i + j]);
  }
  PackInternal(buffers->internal, columns_ + 1, next);
}

template <class Real>
void EffectStep<Real>::ClearGradient(EffectBuffers* buffers) const {
  buffers->gradient.assign(1, SystemGradient(changed().system));
  buffers->start_bar.setZero(3, columns_ - nodes_);
  buffers->end_bar.setZero(3, columns_ - nodes_);
}

template <class Real>
void EffectStep<Real>::AddForcesAdjoint(double time, double step, const State& state,
                                        const NodeForces<Real>& force_bar, State* state_bar,
                                        EffectBuffers* buffers) const {
  Unpack(state, buffers);
  buffers->force.setZero(3, columns_);
  for (int i = 0; i < nodes_; ++i) {
    for (int j = 0; j < 3; ++j) buffers->force(j, i) = static_cast<double>(force_bar[i].f[j]);
  }
  buffers->internal_bar.resize(effects_.internal_size());
  UnpackInternal(*state_bar, columns_ + 1, &buffers->internal_bar);
  buffers->x_bar.setZero(3, columns_);
  buffers->v_bar.setZero(3, columns_);
  effects_.AddForcesAdjoint({time, step, buffers->x, buffers->v}, buffers->internal, buffers->force,
                            &buffers->internal_bar, &buffers->x_bar, &buffers->v_bar,
                            buffers->gradient.data());
  for (int i = 0; i < columns_; ++i) {
    for (int j = 0; j < 3; ++j) {
      (*state_bar)[i].x[j] += static_cast<Real>(buffers->x_bar(j, i));
      (*state_bar)[i].v[j] += static_cast<Real>(buffers->v_bar(j, i));
    }
  }
  PackInternal(buffers->internal_bar, columns_ + 1, state_bar);
}

template <class Real>
void EffectStep<Real>::TakeControllers(double fraction, double frame_time, State* state_bar,
                                       EffectBuffers* buffers) const {
  const double per_time = frame_time > 0 ? 1 / frame_time : 0;
  for (int i = nodes_; i < columns_; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double x_bar = static_cast<double>((*state_bar)[i].x[j]);
      const double v_bar = static_cast<double>((*state_bar)[i].v[j]) * per_time;
      buffers->start_bar(j, i - nodes_) += (1 - fraction) * x_bar - v_bar;
      buffers->end_bar(j, i - nodes_) += fraction * x_bar + v_bar;
    }
    (*state_bar)[i] = {};
  }
}

template <class Real>
void EffectStep<Real>::FinishGradient(const Points& start_rate, const Points& end_rate,
                                      const EffectBuffers& buffers,
                                      SystemGradient* gradient) const {
  *gradient += buffers.gradient[0];
  double delay_bar = 0;
  if (start_rate.cols() == buffers.start_bar.cols()) {
    delay_bar += buffers.start_bar.cwiseProduct(start_rate).sum();
  }
  if (end_rate.cols() == buffers.end_bar.cols()) {
    delay_bar += buffers.end_bar.cwiseProduct(end_rate).sum();
  }
  effects_.ChangeAdjoint(delay_bar, gradient);
}

template class EffectStep<float>;
template class EffectStep<double>;

}  // namespace physpring
