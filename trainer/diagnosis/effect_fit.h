// SPDX-License-Identifier: Apache-2.0
// Fits of bodies with effects: the body's common factors and the effects' parameters together, by
// Levenberg-Marquardt, and single springs besides, by Gauss-Newton.
#ifndef PHYSPRING_TRAINER_DIAGNOSIS_EFFECT_FIT_H_
#define PHYSPRING_TRAINER_DIAGNOSIS_EFFECT_FIT_H_

#include <limits>
#include <memory>
#include <vector>

#include "trainer/diagnosis/diagnosis_body.h"
#include "trainer/diagnosis/effect_problem.h"
#include "trainer/journal/journal.h"

namespace physpring {

// Mean track errors, m; NaN where there are no such frames.
struct TrackPair {
  double fit, held;
};

struct EffectFit {
  std::size_t body = 0;
  double start_substeps = 0;        // a frame, as stiff as which the body's springs began
  std::vector<EffectValues> start;  // of the effects, as the search began
  Eigen::VectorXd x;                // common factors, then effects (effect_model.h)
  double misfit = std::numeric_limits<double>::infinity();  // mean of r^2, m^2, where last fitted
  double damping = 1e-2;
  bool converged = false;
  bool trained = false;  // the system comes from a training, not from `body`

  // From Judge and RefitSprings.
  SpringMassSystem system;
  bool controller_velocity = true;  // whether dashpots feel it
  FrameTrack held;
  TrackPair track{};
};

// Sets `held` and `track` from the particles' predicted positions, those of each recording.
void ScorePrediction(const std::vector<SplitRecording>& recordings,
                     const std::vector<std::vector<Points>>& predicted, EffectFit* fit);

// What a piece of work with this fit depends on, besides the fit's x.
PieceKey KeyOf(const std::string& kind, const EffectFit& fit);

class EffectFitting {
 public:
  // `journal` (it must outlive this) keeps what is worked out; without one nothing is kept.
  EffectFitting(std::vector<DiagnosisBody> bodies, std::vector<SplitRecording> recordings,
                int threads, Journal* journal = nullptr);
  EffectFitting(const EffectFitting&) = delete;
  EffectFitting& operator=(const EffectFitting&) = delete;

  const std::vector<DiagnosisBody>& bodies() const { return bodies_; }
  const std::vector<SplitRecording>& recordings() const { return recordings_; }
  int threads() const { return threads_; }
  Journal& journal() const { return journal_ ? *journal_ : *own_journal_; }
  double difference() const;  // step of forward differences; longer where contacts jump

  // A fit of that body that begins as soft or stiff as predicts best under the highest gain. Not
  // fitted yet; its x is empty if the motion diverges at each stiffness.
  EffectFit Begin(std::size_t body, const std::vector<EffectValues>& effects) const;

  EffectModel Model(const EffectFit& fit) const;
  // Under an observer of this gain, which sees the fit frames only.
  EffectProblem Problem(const EffectFit& fit, double gain) const;

  // At most `steps` of Levenberg-Marquardt for each of the fits, on several threads. Those that
  // cannot be evaluated are taken out.
  void Descend(double gain, int steps, std::vector<EffectFit>* fits) const;

  // Predicts everything; false if a motion diverges.
  bool Judge(EffectFit* fit) const;
  void JudgeAll(std::vector<EffectFit>* fits) const;  // those that diverge are taken out

  // Single springs, too, under an observer and then for at most `steps` without one; the fit
  // stays as it is if that diverges.
  void RefitSprings(int steps, EffectFit* fit) const;

 private:
  SpringMassSystem Base(std::size_t body, double start_substeps) const;
  bool Predict(EffectProblem* problem, const Eigen::VectorXd& x, EffectFit* fit) const;
  EffectProblem MakeProblem(const EffectModel& model, const DiagnosisBody& body, double gain,
                            int threads) const;
  bool DescendOne(double gain, int steps, int threads, EffectFit* fit) const;

  std::vector<DiagnosisBody> bodies_;
  std::vector<SplitRecording> recordings_;
  std::vector<SplitRecording> followed_;  // the same with the fit frames only
  int threads_;
  Journal* journal_;
  std::unique_ptr<Journal> own_journal_ = std::make_unique<Journal>();
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_DIAGNOSIS_EFFECT_FIT_H_
