// SPDX-License-Identifier: Apache-2.0
// An observer: it keeps a rollout near the measured points, so that a model can be fitted by what
// it gets wrong within a few frames, whatever happened before. After each frame, a point that is
// measured at p and predicted at x is corrected, at `fps` frames a second, by
//   r = p - x,   x <- x + a r,   v <- v + b fps r,   b = a^2 / (2 - a)
// the alpha-beta filter, with Benedict and Bordner's choice of b (IRE Trans. Autom. Control 7,
// 1962). With gain a the model is on its own for about 1 / a frames. The residuals of a fit are
// taken before the correction: the prediction errors of system identification (Ljung, System
// Identification, 1999, ch. 7). Fitted with a gain that falls step by step to 0, parameters that
// are far off, and motions that slip or topple at one moment or another, do not lead the fit into a
// side valley. A measurement that counts less than the average (Recording::weight) has that part of
// the gain.
#ifndef PHYSPRING_TRAINER_MOTION_OBSERVER_H_
#define PHYSPRING_TRAINER_MOTION_OBSERVER_H_

#include <array>

#include "twin/node_state.h"
#include "twin/recording.h"

namespace physpring {

// The gains of fits, one after the other. Many fits take a part of them (docs/physics.md).
inline constexpr std::array<double, 5> kObserverGains = {0.5, 0.2, 0.1, 0.05, 0};
inline constexpr int kLastGain = static_cast<int>(kObserverGains.size()) - 1;

// Corrects the state after a frame, predicted at `position` (3 x nodes), with this gain: 0 (nothing
// is corrected) ... 1.
template <class Real>
void Observe(double gain, const Recording& recording, int frame, const Points& position,
             NodeStates<Real>* state);

// Adjoint of Observe: the state's derivatives from those after the correction to those before.
template <class Real>
void ObserveAdjoint(double gain, const Recording& recording, int frame,
                    NodeStates<Real>* state_bar);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_MOTION_OBSERVER_H_
