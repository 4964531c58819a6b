// SPDX-License-Identifier: Apache-2.0
// Fits of hypotheses (hypothesis.h): the body's numbers and the effects' parameters together, by
// Levenberg-Marquardt.
#ifndef PHYSPRING_DIAGNOSIS_FITTING_H_
#define PHYSPRING_DIAGNOSIS_FITTING_H_

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/diagnosis_body.h"
#include "diagnosis/hypothesis.h"
#include "trainer/journal/journal.h"

namespace physpring {

// Sets `held` and `track` of the verdict from the particles' predicted positions in each recording.
void ScorePrediction(const std::vector<SplitRecording>& recordings,
                     const std::vector<std::vector<Points>>& predicted, Verdict* verdict);

// What a piece of work with this hypothesis depends on, besides where its descent is.
PieceKey KeyOf(const std::string& kind, const Hypothesis& hypothesis);

class Fitting {
 public:
  // `journal` (it must outlive this) keeps what is worked out; without one nothing is kept. In
  // recordings from before a change only the first `lasting_effects` act.
  Fitting(std::vector<DiagnosisBody> bodies, std::vector<SplitRecording> recordings, int threads,
          Journal* journal = nullptr, std::size_t lasting_effects = 0);
  Fitting(const Fitting&) = delete;
  Fitting& operator=(const Fitting&) = delete;

  const std::vector<DiagnosisBody>& bodies() const { return bodies_; }
  const std::vector<SplitRecording>& recordings() const { return recordings_; }
  int threads() const { return threads_; }
  std::size_t lasting_effects() const { return lasting_effects_; }
  Journal& journal() const { return journal_ ? *journal_ : *own_journal_; }
  double difference() const;  // step of forward differences; longer where contacts jump

  // A descent with that body, not fitted yet. It begins with the stiffness that predicts best under
  // the highest gain. Its x is empty if the motion diverges at each stiffness.
  Descent Begin(std::size_t body, const std::vector<EffectValues>& effects) const;

  // The descent with a smooth body, which begins where the body is.
  Descent Smooth(const Descent& fit, SmoothBody::Numbers numbers) const;

  EffectModel Model(const Hypothesis& hypothesis) const;
  // Rough fits find the way, in single precision; exact ones go to its end.
  enum class Care { kRough, kExact };
  // The problem of fitting a hypothesis under an observer of this gain, which sees the fit frames
  // only.
  EffectProblem Problem(const Hypothesis& hypothesis, double gain, Care care) const;

  // Makes at most `steps` steps of Levenberg-Marquardt for each of the descents, on several
  // threads. Those that cannot be evaluated are taken out.
  void Descend(double gain, Care care, int steps, std::vector<Descent>* descents) const;

  // Predicts everything and judges it; nothing if a motion diverges.
  std::optional<Verdict> Judge(const Descent& descent) const;
  // The verdicts on the descents, in their order. Those that diverge are left out.
  std::vector<Verdict> JudgeAll(const std::vector<Descent>& descents) const;

 private:
  SpringMassSystem Base(std::size_t body, double start_substeps) const;
  // The verdict on the system at x, which comes from that descent.
  std::optional<Verdict> JudgeAt(EffectProblem* problem, const Eigen::VectorXd& x,
                                 const Descent& descent) const;
  EffectProblem MakeProblem(const EffectModel& model, std::size_t body, double gain,
                            Care care) const;
  double MostRate(std::size_t body) const;  // sub-steps a second that the body may take
  bool DescendOne(double gain, Care care, int steps, int threads, Descent* descent) const;

  std::vector<DiagnosisBody> bodies_;
  std::vector<SplitRecording> recordings_;
  std::vector<SplitRecording> followed_;  // the same with the fit frames only
  int threads_;
  Journal* journal_;
  std::size_t lasting_effects_;
  std::unique_ptr<Journal> own_journal_ = std::make_unique<Journal>();
};

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_FITTING_H_
