// SPDX-License-Identifier: Apache-2.0
// Adding effects to a twin's model, one after the other: search, choice, test and training, as
// diagnosis.h lists them.
#ifndef PHYSPRING_TRAINER_DIAGNOSIS_EFFECT_LOOP_H_
#define PHYSPRING_TRAINER_DIAGNOSIS_EFFECT_LOOP_H_

#include <optional>
#include <vector>

#include "trainer/diagnosis/diagnosis.h"
#include "trainer/diagnosis/effect_search.h"

namespace physpring {

class EffectLoop {
 public:
  // `share`: of all work, what the loop is.
  EffectLoop(const EffectFitting& fitting, double noise_floor, const DiagnosisOptions& options,
             const WorkShare& share);

  // The refit of common factors without a new effect, with those that are known; false if the model
  // diverges.
  bool FitCommon(const std::vector<EffectValues>& known);

  // A fit without a new effect from elsewhere: taken if it predicts the held-out frames better.
  void Offer(const EffectFit& fit);

  // Looks for one more effect; false if none is accepted.
  bool Round(int round);

  // Without any new effect, and with those that were accepted.
  const EffectFit& before() const { return before_; }
  const EffectFit& accepted() const { return accepted_; }
  // The same without the springs' own parameters.
  const EffectFit& common() const { return common_; }
  // Of each round.
  const std::vector<EffectRanking>& rankings() const { return rankings_; }
  // How much smaller the errors of held-out frames are, by a paired block bootstrap.
  BootstrapResult Gain(const FrameTrack& without, const FrameTrack& with) const;

 private:
  WorkShare ShareOf(int round) const;
  bool IsExplained(int round) const;
  EffectSearchResult Search(const WorkShare& stage);
  void FindRival(const EffectSearchResult& search, std::size_t chosen);
  bool IsSurelyBetter(const EffectFit& many, const EffectFit& few) const;
  bool IsWorthIt(const EffectFit& without, const EffectFit& with, double least_gain,
                 int tried) const;
  EffectRanking Rank(const EffectSearchResult& search, std::size_t chosen) const;
  void RefitSprings(const WorkShare& stage, const std::vector<EffectFit*>& fits) const;

  const EffectFitting& fitting_;
  double noise_floor_;
  bool open_;  // single springs are refitted, too
  DiagnosisOptions options_;
  WorkShare common_share_, rounds_share_;
  std::vector<const Effect*> effects_;
  int block_;                    // frames, of the bootstrap
  FittedBodies bodies_;          // that effects are added to
  EffectFit common_, accepted_;  // without and with the springs' own parameters
  EffectFit before_;             // accepted_, without any new effect
  // With another effect in the last round, about as good as common_: what is added next tells.
  std::optional<EffectFit> rival_;
  std::vector<EffectRanking> rankings_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_DIAGNOSIS_EFFECT_LOOP_H_
