// SPDX-License-Identifier: Apache-2.0
#include "trainer/lifted_problem.h"

#include <algorithm>
#include <cmath>

namespace physpring {
namespace {

// Calls visit(episode, frame, point) for everything seen in frames 1 and later, in a fixed order.
template <class Visit>
void ForEachSeen(const LiftedMotion& motion, Visit visit) {
  for (int e = 0; e < motion.episode_count(); ++e) {
    for (int frame = 1; frame < motion.frames(e); ++frame) {
      const Points& measured = motion.recording(e).points[frame];
      for (int i = 0; i < measured.cols(); ++i) {
        if (!std::isnan(measured(0, i))) visit(e, frame, i);
      }
    }
  }
}

}  // namespace

LiftedProblem::LiftedProblem(const Parameters& parameters, const LiftedMotion& motion,
                             double difference)
    : parameters_(parameters), motion_(motion), difference_(difference) {
  ForEachSeen(motion_, [&](int, int, int) { size_ += 3; });
}

Eigen::VectorXd LiftedProblem::ResidualsOf(const LiftedMotion::Motion& motion) const {
  Eigen::VectorXd residuals(size_);
  Eigen::Index row = 0;
  ForEachSeen(motion_, [&](int e, int frame, int i) {
    residuals.segment<3>(row) =
        motion.particles[e][frame].col(i) - motion_.recording(e).points[frame].col(i);
    row += 3;
  });
  return residuals;
}

std::optional<Eigen::VectorXd> LiftedProblem::Residuals(const Eigen::VectorXd& x) {
  const SpringMassSystem system = parameters_.Apply(x);
  const auto motion = motion_.Run(system, motion_.Substeps(system));
  if (!motion) return {};
  return ResidualsOf(*motion);
}

std::optional<Eigen::VectorXd> LiftedProblem::Linearise(const Eigen::VectorXd& x) {
  x_ = x;
  system_ = parameters_.Apply(x);
  substeps_ = motion_.Substeps(system_);
  at_ = motion_.Run(system_, substeps_);
  if (!at_) return {};
  r_ = ResidualsOf(*at_);
  return r_;
}

Eigen::VectorXd LiftedProblem::JacobianTimes(const Eigen::VectorXd& v) {
  const double step = difference_ / std::max(1e-300, v.cwiseAbs().maxCoeff());
  const auto moved = motion_.Run(parameters_.Apply(x_ + step * v), substeps_);
  if (!moved) return Eigen::VectorXd::Zero(r_.size());
  return (ResidualsOf(*moved) - r_) / step;
}

Eigen::VectorXd LiftedProblem::JacobianTransposedTimes(const Eigen::VectorXd& u) {
  LiftedMotion::Frames bars = LiftedMotion::ZerosLike(at_->particles);
  Eigen::Index row = 0;
  ForEachSeen(motion_, [&](int e, int frame, int i) {
    bars[e][frame].col(i) = u.segment<3>(row);
    row += 3;
  });
  return parameters_.Adjoint(x_, system_, motion_.Adjoint(system_, *at_, bars, &cuts_));
}

}  // namespace physpring
