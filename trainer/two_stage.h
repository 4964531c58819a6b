// SPDX-License-Identifier: Apache-2.0
// The fit of level 0 as PhysTwin does it, as the baseline to compare with. Two stages:
//   search       CMA-ES over 12 variables (phystwin_variables.h), 20 generations; springs searched
//                anew for each candidate; objective: mean loss over the fit frames
//   first order  every spring and the contact coefficients, by Adam with one-frame gradients
//                (first_order_stage.h): 200 passes over the fit frames, 100 for a sheet
// Losses and weights as published (loss.h).
//
// What differs from the published program: true masses (the motion is the same); contact changes
// velocities only, the particles of a spring never collide (contact.h), nodes touch the ground
// where start_system.h says; sub-steps from the stability bound unless given; the controllers'
// velocity in the dashpots as the options say (published: off); radii scaled to recordings with
// wider spacing; drag and dashpot not cut to whole numbers; losses divided by true counts, no
// acceleration term. Several recordings are one objective, and one gradient in each step. Particles
// collide with each other only if the options say so (published: on for cloth).
#ifndef PHYSPRING_TRAINER_TWO_STAGE_H_
#define PHYSPRING_TRAINER_TWO_STAGE_H_

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "trainer/cma_es.h"
#include "trainer/first_order_stage.h"
#include "trainer/fitter.h"
#include "trainer/rollout.h"
#include "trainer/train_options.h"

namespace physpring {

class TwoStageFit : public Fitter {
 public:
  // Throws Error where the recordings give no connected body, or one that no controller can move.
  TwoStageFit(FitData data, const TrainOptions& options);

  // As many candidates of a generation as there are threads, or one pass of the second stage.
  // Throws Error if no candidate of the first generation can be simulated.
  bool Step() override;

  double Progress() const override;
  std::string Status() const override { return status_; }
  std::map<std::string, NpzArray> Save() const override;
  void Load(const std::map<std::string, NpzArray>& state) override;
  Twin Result() const override;

 private:
  void StepSearch();
  void StepFirstOrder();
  void BeginFirstOrder();
  void ExpectSomeSuccess() const;

  SpringMassSystem SystemAt(const Eigen::VectorXd& point) const;  // of the unit cube
  std::vector<double> Objectives(const std::vector<Eigen::VectorXd>& points) const;
  int Substeps(const SpringMassSystem& system) const;  // a frame
  RolloutOptions RolloutOptionsFor(const SpringMassSystem& system) const;
  std::string DescribeBest() const;

  FitData data_;
  TrainOptions options_;
  double length_scale_;
  int passes_;  // of the second stage

  CmaEs search_;
  std::vector<double> objectives_;  // of this generation's candidates, as far as known
  std::optional<FirstOrderStage> first_order_;
  std::string status_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_TWO_STAGE_H_
