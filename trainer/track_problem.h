// SPDX-License-Identifier: Apache-2.0
// Fitting a spring-mass system to recordings as a least-squares problem: the residuals are the
// distances, along x, y and z, of predicted from measured points, seen ones only [m].
#ifndef PHYSPRING_TRAINER_TRACK_PROBLEM_H_
#define PHYSPRING_TRAINER_TRACK_PROBLEM_H_

#include <cmath>
#include <memory>
#include <vector>

#include "trainer/gauss_newton.h"
#include "trainer/parameters.h"
#include "trainer/rollout.h"
#include "twin/stability.h"

namespace physpring {

// Root mean square distance of points, mm, from the mean square of their coordinates' residuals.
inline double PointMillimetres(double mean_square) { return 1e3 * std::sqrt(3 * mean_square); }

class TrackProblem : public LeastSquares {
 public:
  struct Options {
    RolloutOptions rollout;       // substeps: 0 = from the stability bound
    double safety = kStepSafety;  // sub-step as a part of the largest stable one
    int most_substeps = 2000;     // a frame; a stiffer system cannot be evaluated
    double difference = 1e-5;     // longest entry of the step of J v; longer where contacts jump
    int threads = 1;
  };

  TrackProblem(const Parameters& parameters, std::vector<Episode> episodes, const Options& options);
  TrackProblem(Parameters&& parameters, std::vector<Episode> episodes,
               const Options& options) = delete;  // it is kept by reference

  std::optional<Eigen::VectorXd> Residuals(const Eigen::VectorXd& x) override;
  std::optional<Eigen::VectorXd> Linearise(const Eigen::VectorXd& x) override;
  Eigen::VectorXd JacobianTimes(const Eigen::VectorXd& v) override;
  Eigen::VectorXd JacobianTransposedTimes(const Eigen::VectorXd& u) override;

  // Sub-steps a frame for the system; 0 if more than most_substeps would be needed.
  int Substeps(const SpringMassSystem& system) const;

  // How often the adjoint was cut in the last JacobianTransposedTimes.
  int cuts() const { return cuts_; }

 private:
  std::optional<Eigen::VectorXd> RollOutAll(const Eigen::VectorXd& x, int substeps,
                                            std::vector<std::unique_ptr<Rollout>>* rollouts) const;

  const Parameters& parameters_;
  std::vector<Episode> episodes_;
  Options options_;
  std::vector<std::size_t> offset_;  // of each episode's residuals; the last one: their number
  // the point of linearisation
  Eigen::VectorXd x_, r_;
  SpringMassSystem system_;
  int substeps_ = 0;
  std::vector<std::unique_ptr<Rollout>> rollouts_;
  int cuts_ = 0;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_TRACK_PROBLEM_H_
