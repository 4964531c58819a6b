// SPDX-License-Identifier: Apache-2.0
// Fitting a model with effects to recordings as a least-squares problem, and judging it on frames
// that are not fitted. Residuals: distances, along x, y and z, of predicted from measured points,
// seen ones only [m].
#ifndef PHYSPRING_TRAINER_DIAGNOSIS_EFFECT_PROBLEM_H_
#define PHYSPRING_TRAINER_DIAGNOSIS_EFFECT_PROBLEM_H_

#include <memory>
#include <optional>
#include <vector>

#include "trainer/diagnosis/effect_model.h"
#include "trainer/diagnosis/split_recording.h"
#include "trainer/gauss_newton.h"
#include "trainer/rollout.h"
#include "twin/stability.h"

namespace physpring {

// Mean distance of predicted from measured points of each frame of one use, in order; frames in
// which nothing was seen are left out.
using FrameTrack = std::vector<double>;

// Sub-steps a second of a diagnosis, at least: what a soft body predicts must not hang on the step,
// or an effect is taken for a remedy because it makes the body stiffer and so the step finer.
constexpr double kLeastDiagnosisRate = 2000;

// Sub-steps a second that a diagnosed system takes on recordings of that rate.
int DiagnosisRate(const SpringMassSystem& system, double fps);

class EffectProblem : public LeastSquares {
 public:
  struct Options {
    bool controller_velocity = true;
    double safety = kStepSafety;  // sub-step as a part of the largest stable one
    double least_rate = 0;        // sub-steps a second
    double most_rate = 10000;     // the same; a stiffer system cannot be evaluated
    double difference = 1e-5;     // longest entry of the step of J v; longer where contacts jump
    // Dashpots that would need a higher rate are lowered, all by one factor. There is no adjoint of
    // that.
    bool limit_dashpots = false;
    int threads = 1;
    bool single_precision = false;
    double observer_gain = 0;  // corrects towards all that the recordings see, whatever its use
  };

  EffectProblem(EffectModel model, const std::vector<SplitRecording>& recordings,
                const Options& options);

  const EffectModel& model() const { return model_; }
  SpringMassSystem SystemAt(const Eigen::VectorXd& x) const;

  // The sub-steps that x needs, used from now on; false if that is too many.
  bool FixSubsteps(const Eigen::VectorXd& x);

  // Nothing also where x needs more sub-steps than are fixed, or than may be.
  std::optional<Eigen::VectorXd> Residuals(const Eigen::VectorXd& x) override;
  std::optional<Eigen::VectorXd> Linearise(const Eigen::VectorXd& x) override;
  Eigen::VectorXd JacobianTimes(const Eigen::VectorXd& v) override;
  Eigen::VectorXd JacobianTransposedTimes(const Eigen::VectorXd& u) override;

  // Predicted positions of all frames up to the last one in use, of each recording; nothing if a
  // motion diverges.
  std::optional<std::vector<std::vector<Points>>> Predict(const Eigen::VectorXd& x) const;

 private:
  bool IsStable(const SpringMassSystem& system) const;
  std::optional<Eigen::VectorXd> RollOutAll(const SpringMassSystem& system, bool fit_only,
                                            std::vector<std::unique_ptr<Rollout>>* rollouts) const;

  EffectModel model_;
  const std::vector<SplitRecording>& recordings_;
  Options options_;
  double shortest_step_;             // s: all recordings' frames have a whole number of such
  std::vector<int> substeps_;        // of each recording
  std::vector<std::size_t> offset_;  // of each recording's residuals; the last one: their number
  // the point of linearisation
  Eigen::VectorXd x_, r_;
  std::vector<std::unique_ptr<Rollout>> rollouts_;
};

// Track errors of predicted positions.
FrameTrack TrackOf(const std::vector<SplitRecording>& recordings,
                   const std::vector<std::vector<Points>>& predicted, SplitRecording::Use use);
double Mean(const FrameTrack& track);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_DIAGNOSIS_EFFECT_PROBLEM_H_
