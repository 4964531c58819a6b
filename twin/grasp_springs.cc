// SPDX-License-Identifier: Apache-2.0
#include "twin/grasp_springs.h"

#include <algorithm>

namespace physpring {
template <class Real>
GraspSprings<Real>::GraspSprings(const SpringMassSystem& system, const ControllerMask& late,
                                 const SpringBlocks<Real>& blocks, int first_record)
    : nodes_(system.node_count()), first_record_(first_record) {
  for (int slot = 0; slot < blocks.size(); ++slot) {
    const int e = blocks.spring[slot];
    if (e < 0 || !system.IsControllerSpring(e)) continue;
    const auto [node, end] = std::minmax(system.springs[e][0], system.springs[e][1]);
    springs_.push_back({e, node, end - nodes_, slot});
  }
  std::sort(springs_.begin(), springs_.end(),
            [](const Spring& a, const Spring& b) { return a.index < b.index; });
  for (Spring& spring : springs_) {
    if (Has(late, spring.controller)) spring.length = lengths_++;
  }
}

template <class Real>
void GraspSprings<Real>::Attach(const Attachment& attachment, State* state) const {
  const auto& [attached, controllers, nodes] = attachment;
  Real* length = Lengths(state);
  for (const Spring& spring : springs_) {
    if (spring.length < 0 || !Has(attached, spring.controller)) continue;
    const double distance = (controllers.col(spring.controller) - nodes.col(spring.node)).norm();
    length[spring.length] = static_cast<Real>(distance);
  }
}

template <class Real>
void GraspSprings<Real>::Apply(const ControllerMask& released, const State& state,
                               LevelStep<Real>* step) const {
  const Real* length = Lengths(state);
  for (const Spring& spring : springs_) {
    if (IsSet(spring, length)) step->SetRestLength(spring.slot, length[spring.length]);
    if (Has(released, spring.controller)) step->OpenSpring(spring.slot);
  }
}

template <class Real>
void GraspSprings<Real>::ApplyAdjoint(const ControllerMask& released, const State& state,
                                      SystemGradient* gradient) const {
  const Real* length = Lengths(state);
  for (const Spring& spring : springs_) {
    if (Has(released, spring.controller)) {
      gradient->stiffness[spring.index] = gradient->dashpot[spring.index] = 0;
    }
    if (IsSet(spring, length)) gradient->rest_length[spring.index] = 0;
  }
}

template <class Real>
void GraspSprings<Real>::ReadLengths(const State& state, Eigen::VectorXd* rest_length) const {
  const Real* length = Lengths(state);
  for (const Spring& spring : springs_) {
    if (!IsSet(spring, length)) continue;
    (*rest_length)[spring.index] = static_cast<double>(length[spring.length]);
  }
}

template <class Real>
void GraspSprings<Real>::CopyLengths(const State& from, State* to) const {
  std::copy_n(Lengths(from), lengths_, Lengths(to));
}

template class GraspSprings<float>;
template class GraspSprings<double>;

}  // namespace physpring
