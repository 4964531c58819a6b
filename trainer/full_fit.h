// SPDX-License-Identifier: Apache-2.0
// The fit of level 0, by gradients and sensitivities of full rollouts, in stages:
//   choose        the model and the start values of its common factors (model_choice.h)
//   common        the same factors again, by Levenberg-Marquardt on all fit frames, under an
//                 observer whose gain falls to 0 (observer.h); left out where the choice has fitted
//                 single springs, which the next stage goes on from
//   Gauss-Newton  every spring's own stiffness, dashpot and rest length, while it gets on; so, too
//   Adam          goes on where contacts or chaotic motions make residuals too rough for that
// A chain that bends (fit_model.h) has its common factors fitted to more recordings, then
//   search        goes on with them, by values of the error alone (free_motion_search.h)
// The start is over-damped and soft: its stiffness is the one of a few (measured in sub-steps a
// frame) that predicts the fit frames best.
#ifndef PHYSPRING_TRAINER_FULL_FIT_H_
#define PHYSPRING_TRAINER_FULL_FIT_H_

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "trainer/fitter.h"
#include "trainer/free_motion_search.h"
#include "trainer/gauss_newton.h"
#include "trainer/model_choice.h"
#include "trainer/parameters.h"
#include "trainer/train_options.h"

namespace physpring {

class FullFit : public Fitter {
 public:
  FullFit(FitData data, const TrainOptions& options);

  // Throws Error if the motion diverges with the start values of every candidate.
  bool Step() override;
  double Progress() const override;
  std::string Status() const override { return status_; }
  std::string Part() const override;
  std::map<std::string, NpzArray> Save() const override;
  void Load(const std::map<std::string, NpzArray>& arrays) override;
  Twin Result() const override;

 private:
  enum class Stage { kChoose, kCommon, kSearch, kDescend, kGaussNewton, kAdam, kDone };

  // Everything that the next step depends on, besides data, options and the choice.
  struct State {
    Stage stage = Stage::kChoose;
    int gain = 0;       // of kObserverGains
    int iteration = 0;  // of the stage, with this gain
    int slow = 0;       // steps in a row that gained little
    double damping = 0;
    double mean_square = 0;                       // of the residuals at x
    double rate = 1;                              // of Adam, relative to its schedule
    double best_mean_square = 0;                  // Adam's best ...
    double gained_mean_square = 0;                // ... when it last gained more than little
    double error = 0;                             // of a chain's free motions, m
    Eigen::VectorXd best;                         // the x of the best
    Eigen::VectorXd x;                            // common factors, then with the springs' own
    Eigen::VectorXd adam_mean, adam_mean_square;  // of the gradient
  };

  void StepChoose();
  void StepCommon();
  void BeginSearch();
  void StepSearch();
  void StepDescend();
  void StepGaussNewton();
  void StepAdam();
  void BeginGaussNewton(const Eigen::VectorXd& x);
  int GaussNewtonSteps() const;
  int AdamSteps() const;
  void BeginAdam(bool wanted);

  const Recording& first() const { return data_.recordings[0]; }
  Parameters SpringParameters() const;
  SpringMassSystem CurrentSystem() const;

  FitData data_;
  TrainOptions options_;
  ModelChoice choice_;
  ChosenModel model_;  // from the stage `common` on
  std::vector<Episode> all_;
  std::optional<FreeMotionSearch> search_;  // from that stage on
  State state_;
  std::string status_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FULL_FIT_H_
