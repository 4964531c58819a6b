// SPDX-License-Identifier: Apache-2.0
// The fit of the parameters of a coarse level, whose topology, masses and first values are a
// Galerkin projection, to the measured points through the lift, in three stages:
//   common   the same few factors for all springs (parameters.h), by Levenberg-Marquardt, under an
//            observer whose gain falls to 0 (observer.h)
//   network  corrections by the graph network and of the contact (network/corrections_fit.h)
//   springs  every spring's own stiffness, dashpot and rest length, by Gauss-Newton
#ifndef PHYSPRING_TRAINER_LEVEL_FIT_H_
#define PHYSPRING_TRAINER_LEVEL_FIT_H_

#include <string>

#include "trainer/fitter.h"
#include "trainer/gauss_newton.h"
#include "trainer/held_back.h"
#include "trainer/lifted_motion.h"
#include "trainer/network/corrections_fit.h"
#include "trainer/network/graph_network.h"
#include "trainer/parameters.h"
#include "trainer/state_arrays.h"
#include "trainer/train_options.h"

namespace physpring {

class LevelFit {
 public:
  // Fits the last level of `twin`, with a network of these weights; data and network must outlive
  // this.
  LevelFit(const FitData& data, const TrainOptions& options, const Twin& twin,
           const GraphNetwork& network, const Eigen::VectorXd& weights);

  // As Fitter's; on so many threads at most.
  bool Step(int threads);
  double Progress() const;
  std::string Part() const;
  const std::string& Status() const { return status_; }
  StateArrays Save() const;
  void Load(const StateArrays& state);

  // The level as fitted so far.
  SpringMassSystem System() const;
  int SubstepsPerSecond() const;
  const Eigen::VectorXd& weights() const { return corrections_.best_weights(); }
  // Whether the common factors are fitted under the observer's last gain above 0, and the mean
  // square of the residuals then, m^2: what candidates are judged by.
  bool can_be_judged() const { return ProgressOfTrial() == 1; }
  double ProgressOfTrial() const;
  double mean_square() const { return mean_square_; }

 private:
  enum class Stage { kCommon, kNetwork, kSprings, kDone };

  LiftedMotion::Options MotionOptions(int threads, double gain = 0) const;
  Parameters CommonParameters() const;
  Parameters SpringParameters() const;
  CorrectionsFit BeginCorrections(const Eigen::VectorXd& weights) const;
  SpringMassSystem NetworkBase(const Eigen::VectorXd& contact) const;
  SpringMassSystem CorrectedSystem() const;
  double HeldBackError(const SpringMassSystem& system) const;
  void BeginSprings();
  void StepCommon();
  void StepNetwork();
  void StepSprings();

  const FitData& data_;
  TrainOptions options_;
  Twin twin_;
  int level_;
  int most_substeps_;  // a frame
  HeldBack held_back_;
  const GraphNetwork& network_;

  // Everything that the next step depends on, besides data, options and the twin.
  Stage stage_ = Stage::kCommon;
  int iteration_ = 0;  // of the stage; of the common factors, with this gain
  int gain_;           // of kObserverGains
  double damping_ = 1e-2;
  double mean_square_ = 0;  // of the residuals
  Eigen::VectorXd common_, springs_;
  CorrectionsFit corrections_;
  std::string status_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_LEVEL_FIT_H_
