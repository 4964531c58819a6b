// SPDX-License-Identifier: Apache-2.0
// The fit of level 0, by gradients and sensitivities of full rollouts, in three stages:
//   choose   for each candidate neighbour count: start values by Levenberg-Marquardt on a few
//            common factors (parameters.h), horizon growing, judged by held-back frames
//   common   the same factors again, on all fit frames, from the best candidate's values
//   springs  every spring's own stiffness, dashpot and rest length, with the exact adjoint:
//            Gauss-Newton while it gets on, then Adam
// The start is over-damped and soft: its stiffness is the one of a few (measured in sub-steps a
// frame) that predicts the fit frames best.
#ifndef PHYSPRING_TRAINER_FULL_FIT_H_
#define PHYSPRING_TRAINER_FULL_FIT_H_

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "trainer/fitter.h"
#include "trainer/gauss_newton.h"
#include "trainer/held_back.h"
#include "trainer/levenberg_marquardt.h"
#include "trainer/parameters.h"
#include "trainer/track_problem.h"
#include "trainer/train_options.h"

namespace physpring {

class FullFit : public Fitter {
 public:
  FullFit(FitData data, const TrainOptions& options);

  // Throws Error if the motion diverges with the start values of every candidate.
  bool Step() override;
  double Progress() const override;
  std::string Status() const override { return status_; }
  std::map<std::string, NpzArray> Save() const override;
  void Load(const std::map<std::string, NpzArray>& state) override;
  Twin Result() const override;

 private:
  enum class Stage { kChoose, kCommon, kGaussNewton, kAdam, kDone };

  // Everything that the next step depends on, besides data and options.
  struct State {
    Stage stage = Stage::kChoose;
    int candidate = 0;          // index of the neighbour count being tried, then the chosen one
    int horizon = 0;            // index of the part of the fit frames in use
    int iteration = 0;          // of the current stage and horizon
    double start_substeps = 0;  // of the current candidate's start system; 0: not yet searched
    Eigen::VectorXd x;          // common factors, then with the springs' own
    double damping = 0;
    double mean_square = 0;                       // of the residuals at x
    Eigen::VectorXd adam_mean, adam_mean_square;  // of the gradient
    double best_mean_square = 0;                  // Adam's best ...
    Eigen::VectorXd best_springs;                 // ... and its x
    Eigen::VectorXd score;           // of each candidate tried: held-back track error, m
    int best_candidate = -1;         // of those tried; -1: none yet
    double best_start_substeps = 0;  // its start system ...
    Eigen::VectorXd best_x;          // ... and common factors
  };

  void StepChoose();
  void ExpectSomeSuccess() const;
  void StepCommon();
  void StepGaussNewton();
  void StepAdam();
  int GaussNewtonSteps() const;
  int AdamSteps() const;
  void BeginAdam();
  // Contacts make residuals jump: differences are then taken over longer steps.
  bool HasGround() const { return data_.recordings[0].ground.has_value(); }

  SpringMassSystem StartSystem(int candidate, double start_substeps) const;
  double SearchStart(int candidate) const;
  double HeldBackError(const SpringMassSystem& system) const;
  LevenbergMarquardtState StepFactors(const Parameters& parameters,
                                      const std::vector<Episode>& episodes, int difference_threads);
  TrackProblem::Options ProblemOptions() const;
  Parameters CommonParameters(const SpringMassSystem& base) const;
  Parameters SpringParameters() const;
  GaussNewtonOptions Prior(const Parameters& parameters) const;
  SpringMassSystem CurrentSystem() const;

  FitData data_;
  TrainOptions options_;
  std::vector<int> candidates_;
  HeldBack held_back_;
  std::vector<Episode> all_;
  State state_;
  std::string status_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FULL_FIT_H_
