// SPDX-License-Identifier: Apache-2.0
#include "trainer/motion/observer.h"

#include <algorithm>
#include <cmath>

namespace physpring {
namespace {

// Calls correct(i, a, b / T) for every point seen in a frame that is corrected. One that counts
// less than the average corrects less.
template <class Correct>
void ForEachCorrected(double gain, const Recording& recording, int frame, Correct correct) {
  if (gain <= 0) return;
  const Points& measured = recording.points[frame];
  for (int i = 0; i < measured.cols(); ++i) {
    if (std::isnan(measured(0, i))) continue;
    const double a = gain * std::min(1.0, recording.WeightOf(frame, i));
    correct(i, a, a * a / (2 - a) * recording.fps);
  }
}

}  // namespace

template <class Real>
void Observe(double gain, const Recording& recording, int frame, const Points& position,
             NodeStates<Real>* state) {
  ForEachCorrected(gain, recording, frame, [&](int i, double a, double b) {
    for (int j = 0; j < 3; ++j) {
      const double r = recording.points[frame](j, i) - position(j, i);
      (*state)[i].x[j] += static_cast<Real>(a * r);
      (*state)[i].v[j] += static_cast<Real>(b * r);
    }
  });
}

template <class Real>
void ObserveAdjoint(double gain, const Recording& recording, int frame,
                    NodeStates<Real>* state_bar) {
  ForEachCorrected(gain, recording, frame, [&](int i, double a, double b) {
    // forward: x += a (m - x), v += b (m - x)
    NodeState<Real>& bar = (*state_bar)[i];
    for (int j = 0; j < 3; ++j) {
      bar.x[j] -= static_cast<Real>(a) * bar.x[j] + static_cast<Real>(b) * bar.v[j];
    }
  });
}

template void Observe<float>(double, const Recording&, int, const Points&, NodeStates<float>*);
template void Observe<double>(double, const Recording&, int, const Points&, NodeStates<double>*);
template void ObserveAdjoint<float>(double, const Recording&, int, NodeStates<float>*);
template void ObserveAdjoint<double>(double, const Recording&, int, NodeStates<double>*);

}  // namespace physpring
