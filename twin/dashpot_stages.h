// SPDX-License-Identifier: Apache-2.0
// Dashpots in stages: a sub-step that stays stable under stronger dashpots than one of
// semi-implicit Euler. The forces F at (x, v) become mean forces over the sub-step, by damped
// Chebyshev polynomials (the stabilised method of first order of Sommeijer, Shampine, Verwer, RKC,
// 1998):
//   E_0 = E_-1 = 0,  R_0 = 0
//   E_j+1 = keep_j E_j + take_j (F + D(x) R_j) - back_j E_j-1   D: dashpots exert D(x) v
//   R_j = h / m E_j + q_j h g                  by how much velocities change up to stage j
// E_s takes the place of F. One stage is E_1 = F. A mode whose damping rate is gamma is damped by
//   P(h gamma) = T_s(w0 - w1 h gamma) / T_s(w0),  w0 = 1 + 1 / s^2,  w1 = T_s(w0) / T_s'(w0)
// of its velocity, which is 1 - h gamma + O(h^2 gamma^2), and between -0.47 and 0.47 from where it
// first is up to h gamma = (1 + w0) / w1, about 1.26 s^2.
#ifndef PHYSPRING_TWIN_DASHPOT_STAGES_H_
#define PHYSPRING_TWIN_DASHPOT_STAGES_H_

#include <vector>

#include "twin/kernel.h"

namespace physpring {

inline constexpr int kMostDashpotStages = 8;

// What stays stable with two or more stages, at most kMostDashpotStages: h gamma < damping and
// h^2 omega^2 + 2 h gamma_other < stiffness, where gamma_other is of forces that D does not hold.
// (With one, 2 and 4, but h^2 omega^2 + 2 h gamma < 4 together.)
struct DashpotLimits {
  double damping, stiffness;
};
DashpotLimits LimitsOfStages(int stages);

// What a sub-step works in.
template <class Real>
struct DashpotBuffers {
  std::vector<Real> direction;             // SpringView::direction
  std::vector<NodeForces<Real>> velocity;  // R_1 ... R_s, m/s
  NodeForces<Real> before, effect, next;   // E_j-1, E_j, E_j+1
  NodeForces<Real> dashpots;               // D R_j
  // of the adjoint
  NodeStates<Real> next_state, stage, stage_bar;
  NodeForces<Real> before_bar, effect_bar, force_bar, sum_bar;
  std::vector<Real> unused_stiffness, unused_rest_length;
};

template <class Real>
class DashpotStages {
 public:
  explicit DashpotStages(int stages);

  int count() const { return static_cast<int>(stages_.size()); }
  // That leads to E_j+1.
  const StageWeights<Real>& stage(int j) const { return stages_[j]; }

  // `force`: in F, out E_s, of nodes, controllers and the spare node. The springs' directions are
  // those of F.
  void Apply(const Kernel<Real>& kernel, const SpringView<Real>& springs,
             const NodeView<Real>& nodes, NodeForces<Real>* force,
             DashpotBuffers<Real>* buffers) const;

  // Adjoint of Apply, which was called before with the same arguments. `dashpots`: the springs, of
  // stiffness 0. `force_bar`: in d loss / d E_s, out d loss / d F. Adds to the others.
  void ApplyAdjoint(const Kernel<Real>& kernel, const SpringView<Real>& dashpots,
                    const NodeView<Real>& nodes, const NodeStates<Real>& state,
                    NodeForces<Real>* force_bar, NodeStates<Real>* state_bar, Real* dashpot_bar,
                    const NodeGradientView<Real>& gradient, DashpotBuffers<Real>* buffers) const;

 private:
  std::vector<StageWeights<Real>> stages_;
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_DASHPOT_STAGES_H_
