// SPDX-License-Identifier: Apache-2.0
#include "twin/grasp_springs.h"

#include <algorithm>

namespace physpring {
namespace {

constexpr double kShortestRest = 1e-4;  // m: no shift makes a rest length less

}  // namespace

template <class Real>
GraspSprings<Real>::GraspSprings(const SpringMassSystem& system, const ControllerMask& late,
                                 const SpringBlocks<Real>& blocks, int first_record)
    : first_record_(first_record) {
  const int nodes = system.node_count();
  for (int slot = 0; slot < blocks.size(); ++slot) {
    const int e = blocks.spring[slot];
    if (e < 0 || !system.IsControllerSpring(e)) continue;
    const auto [node, end] = std::minmax(system.springs[e][0], system.springs[e][1]);
    const double length = (system.position.col(end) - system.position.col(node)).norm();
    springs_.push_back({e, node, end - nodes, slot, length});
  }
  std::sort(springs_.begin(), springs_.end(),
            [](const Spring& a, const Spring& b) { return a.index < b.index; });
  for (Spring& spring : springs_) {
    if (Has(late, spring.controller)) spring.shift = shifts_++;
  }
}

template <class Real>
void GraspSprings<Real>::Attach(const Attachment& attachment, State* state) const {
  const auto& [attached, controllers, nodes] = attachment;
  Real* shift = Shifts(state);
  for (const Spring& spring : springs_) {
    if (spring.shift < 0 || !Has(attached, spring.controller)) continue;
    const double length = (controllers.col(spring.controller) - nodes.col(spring.node)).norm();
    shift[spring.shift] = static_cast<Real>(length - spring.reference);
  }
}

template <class Real>
void GraspSprings<Real>::Apply(const ControllerMask& released, const State& state,
                               LevelStep<Real>* step) const {
  step->Release(released);
  const Real* shift = Shifts(state);
  for (const Spring& spring : springs_) {
    if (Has(released, spring.controller)) {
      step->OpenSpring(spring.slot);
    } else if (spring.shift >= 0) {
      step->ShiftRestLength(spring.slot, shift[spring.shift], static_cast<Real>(kShortestRest));
    }
  }
}

template <class Real>
void GraspSprings<Real>::ApplyAdjoint(const ControllerMask& released,
                                      SystemGradient* gradient) const {
  for (const Spring& spring : springs_) {
    if (!Has(released, spring.controller)) continue;
    gradient->stiffness[spring.index] = gradient->dashpot[spring.index] = 0;
  }
}

template <class Real>
void GraspSprings<Real>::AddShifts(const State& state, Eigen::VectorXd* rest_length) const {
  const Real* shift = Shifts(state);
  for (const Spring& spring : springs_) {
    if (spring.shift < 0) continue;
    double& length = (*rest_length)[spring.index];
    length = std::max(length + static_cast<double>(shift[spring.shift]), kShortestRest);
  }
}

template <class Real>
void GraspSprings<Real>::CopyShifts(const State& from, State* to) const {
  std::copy_n(Shifts(from), shifts_, Shifts(to));
}

template class GraspSprings<float>;
template class GraspSprings<double>;

}  // namespace physpring
