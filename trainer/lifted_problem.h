// SPDX-License-Identifier: Apache-2.0
// Fitting a level of a twin to recordings as a least-squares problem: the residuals are the
// distances, along x, y and z, of lifted from measured points, seen ones only [m]. At level 0 that
// is TrackProblem.
#ifndef PHYSPRING_TRAINER_LIFTED_PROBLEM_H_
#define PHYSPRING_TRAINER_LIFTED_PROBLEM_H_

#include <optional>

#include "trainer/gauss_newton.h"
#include "trainer/lifted_motion.h"
#include "trainer/parameters.h"

namespace physpring {

class LiftedProblem : public LeastSquares {
 public:
  // `difference`: longest entry of the step of J v; longer where contacts jump. Parameters and
  // motion must outlive this.
  LiftedProblem(const Parameters& parameters, const LiftedMotion& motion, double difference);

  std::optional<Eigen::VectorXd> Residuals(const Eigen::VectorXd& x) override;
  std::optional<Eigen::VectorXd> Linearise(const Eigen::VectorXd& x) override;
  Eigen::VectorXd JacobianTimes(const Eigen::VectorXd& v) override;
  Eigen::VectorXd JacobianTransposedTimes(const Eigen::VectorXd& u) override;

  // How often the adjoint was cut in the last JacobianTransposedTimes.
  int cuts() const { return cuts_; }

 private:
  Eigen::VectorXd ResidualsOf(const LiftedMotion::Motion& motion) const;

  const Parameters& parameters_;
  const LiftedMotion& motion_;
  double difference_;
  Eigen::Index size_ = 0;
  // the point of linearisation
  Eigen::VectorXd x_, r_;
  SpringMassSystem system_;
  int substeps_ = 0;
  std::optional<LiftedMotion::Motion> at_;
  int cuts_ = 0;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_LIFTED_PROBLEM_H_
