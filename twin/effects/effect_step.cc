// SPDX-License-Identifier: Apache-2.0
#include "twin/effects/effect_step.h"

#include <algorithm>

namespace physpring {

template <class Real>
void EffectStep<Real>::Unpack(const State& state, EffectBuffers<Real>* buffers) const {
  buffers->x.resize(3, columns_);
  buffers->v.resize(3, columns_);
  double *x = buffers->x.data(), *v = buffers->v.data();
  for (int i = 0; i < columns_; ++i) {
    for (int j = 0; j < 3; ++j) {
      x[3 * i + j] = static_cast<double>(state[i].x[j]);
      v[3 * i + j] = static_cast<double>(state[i].v[j]);
    }
  }
  UnpackInternal(state, &buffers->internal);
}

template <class Real>
void EffectStep<Real>::UnpackInternal(const State& state, Eigen::VectorXd* internal) const {
  const Real* from = Internal(state, tensions_.end_record());
  internal->resize(effects_.internal_size());
  std::copy(from, from + internal->size(), internal->begin());
}

template <class Real>
void EffectStep<Real>::PackInternal(const Eigen::VectorXd& internal, State* state) const {
  Real* to = Internal(state, tensions_.end_record());
  for (double value : internal) *to++ = static_cast<Real>(value);
}

template <class Real>
void EffectStep<Real>::AddForces(const EffectSubstep<Real>& now, State* next,
                                 NodeForces<Real>* force, EffectBuffers<Real>* buffers) const {
  tensions_.AddForces(now, next, force, &buffers->tension);
  if (!has_node_forces()) return;
  ComputeNodeForces(now, next, buffers);
  const double* added = buffers->force.data();
  for (int i = 0; i < nodes_; ++i) {
    for (int j = 0; j < 3; ++j) (*force)[i].f[j] += static_cast<Real>(added[3 * i + j]);
  }
}

template <class Real>
void EffectStep<Real>::ComputeNodeForces(const EffectSubstep<Real>& now, State* next,
                                         EffectBuffers<Real>* buffers) const {
  Unpack(now.state, buffers);
  buffers->force.setZero(3, columns_);
  effects_.AddForces({now.time, now.step, buffers->x, buffers->v, now.released}, &buffers->internal,
                     &buffers->force);
  PackInternal(buffers->internal, next);
}

template <class Real>
void EffectStep<Real>::ClearGradient(EffectBuffers<Real>* buffers) const {
  tensions_.ClearGradient(&buffers->tension);
  buffers->gradient.assign(1, SystemGradient(changed().system));
  buffers->start_bar.setZero(3, columns_ - nodes_);
  buffers->end_bar.setZero(3, columns_ - nodes_);
}

template <class Real>
void EffectStep<Real>::AddForcesAdjoint(const EffectSubstep<Real>& now,
                                        const NodeForces<Real>& force_bar, State* state_bar,
                                        SpringGradientView<Real> gradient,
                                        EffectBuffers<Real>* buffers) const {
  tensions_.AddForcesAdjoint(now, force_bar, state_bar, gradient, &buffers->tension);
  if (effects_.has_forces()) AddNodeForcesAdjoint(now, force_bar, state_bar, buffers);
}

template <class Real>
void EffectStep<Real>::AddNodeForcesAdjoint(const EffectSubstep<Real>& now,
                                            const NodeForces<Real>& force_bar, State* state_bar,
                                            EffectBuffers<Real>* buffers) const {
  Unpack(now.state, buffers);
  buffers->force.setZero(3, columns_);
  for (int i = 0; i < nodes_; ++i) {
    for (int j = 0; j < 3; ++j) buffers->force(j, i) = static_cast<double>(force_bar[i].f[j]);
  }
  UnpackInternal(*state_bar, &buffers->internal_bar);
  buffers->x_bar.setZero(3, columns_);
  buffers->v_bar.setZero(3, columns_);
  effects_.AddForcesAdjoint({now.time, now.step, buffers->x, buffers->v, now.released},
                            buffers->internal, buffers->force, &buffers->internal_bar,
                            &buffers->x_bar, &buffers->v_bar, buffers->gradient.data());
  for (int i = 0; i < columns_; ++i) {
    for (int j = 0; j < 3; ++j) {
      (*state_bar)[i].x[j] += static_cast<Real>(buffers->x_bar(j, i));
      (*state_bar)[i].v[j] += static_cast<Real>(buffers->v_bar(j, i));
    }
  }
  PackInternal(buffers->internal_bar, state_bar);
}

template <class Real>
void EffectStep<Real>::TakeControllers(double fraction, double frame_time, State* state_bar,
                                       EffectBuffers<Real>* buffers) const {
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
void EffectStep<Real>::FinishControllers(double frame_time, EffectBuffers<Real>* buffers) const {
  // forward: velocity = (end - start) / frame_time
  const Points velocity_bar = buffers->tension.controller_velocity_bar / frame_time;
  buffers->start_bar -= velocity_bar;
  buffers->end_bar += velocity_bar;
}

template <class Real>
void EffectStep<Real>::FinishGradient(const Points& start_rate, const Points& end_rate,
                                      const EffectBuffers<Real>& buffers,
                                      SystemGradient* gradient) const {
  tensions_.AddGradient(buffers.tension, gradient);
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
