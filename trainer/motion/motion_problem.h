// SPDX-License-Identifier: Apache-2.0
// Fitting a system to recordings as a least-squares problem: the residuals are the distances, along
// x, y and z, of predicted from measured particles [m], times the root of the measurement's weight
// (Recording::weight). Only particles that are seen in fitted frames count.
#ifndef PHYSPRING_TRAINER_MOTION_MOTION_PROBLEM_H_
#define PHYSPRING_TRAINER_MOTION_MOTION_PROBLEM_H_

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "trainer/motion/lifted_motion.h"
#include "trainer/motion/system_map.h"
#include "trainer/solvers/gauss_newton.h"

namespace physpring {

// The error of a motion that diverges, and a limit that bounds nothing.
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Root mean square distance of points, mm, from the mean square of their coordinates' residuals.
inline double PointMillimetres(double mean_square) { return 1e3 * std::sqrt(3 * mean_square); }

class MotionProblem : public LeastSquares {
 public:
  struct Options : LiftedMotion::Options {
    double difference = 1e-5;  // longest entry of the step of J v; longer where contacts jump
    // The sub-steps stay as they were fixed until Linearise or FixSubsteps fixes them anew; a
    // system that needs more cannot be evaluated. Else each system takes as many as it needs.
    bool keep_substeps = false;
  };

  // The problem of fitting level 0.
  MotionProblem(SystemMap map, std::vector<Episode> episodes, const Options& options);
  // The problem of fitting the level of `motion`. `difference` is as in Options.
  MotionProblem(SystemMap map, LiftedMotion motion, double difference);

  SpringMassSystem SystemAt(const Eigen::VectorXd& x) const { return map_.Apply(x); }
  const LiftedMotion::Substeps& substeps() const { return substeps_; }

  int residual_count() const { return static_cast<int>(offset_.back()); }

  // Keeps the sub-steps that x needs; false if that is too many.
  bool FixSubsteps(const Eigen::VectorXd& x);

  // Each gives nothing where a motion diverges or would need too many sub-steps. Residuals at
  // several x, or of several systems, at once are the same numbers in less time. They may be asked
  // for by several threads.
  std::vector<std::optional<Eigen::VectorXd>> Residuals(
      const std::vector<Eigen::VectorXd>& xs) const;
  std::vector<std::optional<Eigen::VectorXd>> ResidualsOfSystems(
      std::vector<SpringMassSystem> systems) const;
  std::optional<Eigen::VectorXd> Residuals(const Eigen::VectorXd& x) override;
  std::optional<Eigen::VectorXd> Linearise(const Eigen::VectorXd& x) override;
  Eigen::VectorXd JacobianTimes(const Eigen::VectorXd& v) override;
  Eigen::VectorXd JacobianTransposedTimes(const Eigen::VectorXd& u) override;

  // How often the adjoint was cut in the last JacobianTransposedTimes.
  int cuts() const { return cuts_; }

 private:
  void CountResiduals();
  // With which the residuals of a system are taken; empty where they do not exist.
  LiftedMotion::Substeps SubstepsFor(const SpringMassSystem& system) const;
  // The residuals of one episode, from its particles in each frame.
  void SetResiduals(int e, const std::vector<Points>& particles, Eigen::VectorXd* residuals) const;
  std::vector<std::optional<Eigen::VectorXd>> RollOutSideBySide(
      const std::vector<SpringMassSystem>& systems, const LiftedMotion::Substeps& substeps) const;
  std::optional<Eigen::VectorXd> RollOutAll(const SpringMassSystem& system,
                                            const LiftedMotion::Substeps& substeps,
                                            std::vector<LiftedMotion::Motion>* motions) const;

  SystemMap map_;
  LiftedMotion motion_;
  double difference_;
  bool keep_substeps_ = false;
  // Where each episode's residuals begin; the last one is their number.
  std::vector<std::size_t> offset_ = {0};
  LiftedMotion::Substeps substeps_;
  // the point of linearisation
  Eigen::VectorXd x_, r_;
  SpringMassSystem system_;
  std::vector<LiftedMotion::Motion> motions_;
  int cuts_ = 0;
};

// The residuals of a problem, which must outlive this, for Levenberg-Marquardt.
inline auto ResidualsOf(const MotionProblem& problem) {
  return [&problem](const std::vector<Eigen::VectorXd>& xs) { return problem.Residuals(xs); };
}

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_MOTION_MOTION_PROBLEM_H_
