// SPDX-License-Identifier: Apache-2.0
// Fitting a model with effects to recordings as a least-squares problem (motion_problem.h), and
// judging it on frames that are not fitted. Dashpots that would need more sub-steps than there may
// be are lowered, all by one factor. There are residuals alone, no adjoint.
#ifndef PHYSPRING_DIAGNOSIS_EFFECT_PROBLEM_H_
#define PHYSPRING_DIAGNOSIS_EFFECT_PROBLEM_H_

#include <optional>
#include <vector>

#include "diagnosis/effect_model.h"
#include "diagnosis/split_recording.h"
#include "trainer/motion/motion_problem.h"
#include "trainer/motion/track_error.h"

namespace physpring {

// The fewest sub-steps a second of a diagnosis. What a soft body predicts must not hang on the
// step. Else an effect is taken for a remedy because it makes the body stiffer and so the step
// finer.
constexpr double kLeastDiagnosisRate = 2000;

// Sub-steps a second that a diagnosed system takes on recordings of that rate.
int DiagnosisRate(const SpringMassSystem& system, double fps);

class EffectProblem : public MotionProblem {
 public:
  struct Options : MotionProblem::Options {
    Options();
  };

  EffectProblem(const EffectModel& model, const std::vector<SplitRecording>& recordings,
                const Options& options);

  const EffectModel& model() const { return model_; }

  // For each recording, the predicted positions in all frames up to the last one in use; nothing if
  // a motion diverges.
  std::optional<std::vector<std::vector<Points>>> Predict(const Eigen::VectorXd& x) const;

 private:
  EffectModel model_;
  LiftedMotion all_;  // goes up to the last frame in use
};

// Track errors of predicted positions, one recording after the other, but of none from before a
// change.
FrameTrack TrackOf(const std::vector<SplitRecording>& recordings,
                   const std::vector<std::vector<Points>>& predicted, SplitRecording::Use use);

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_EFFECT_PROBLEM_H_
