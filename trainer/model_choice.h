// SPDX-License-Identifier: Apache-2.0
// The choice of a model (fit_model.h) and of the start values of its common factors, on held-back
// frames. In three rounds, under an observer whose gain falls (observer.h):
//   far      each candidate's factors are fitted with the two highest gains, from the best of a few
//            start stiffnesses and frictions; three with and three without the controllers'
//            velocity go on
//   near     those are fitted with lower gains; the best with and without velocity go on
//   springs  those are fitted a few steps further, spring by spring, with the same low gain, and
//            judged by a free motion as well; a chain that bends (fit_model.h) by its factors
#ifndef PHYSPRING_TRAINER_MODEL_CHOICE_H_
#define PHYSPRING_TRAINER_MODEL_CHOICE_H_

#include <string>
#include <vector>

#include "trainer/chosen_model.h"
#include "trainer/held_back.h"
#include "trainer/state_arrays.h"

namespace physpring {

class ModelChoice {
 public:
  // Keeps a reference to `data`. Computes in single precision: for a choice that is enough.
  ModelChoice(const FitData& data, const TrainOptions& options);

  // One step of an optimiser, of as many candidates at a time as there are threads. False when the
  // choice is made. Throws Error if the motion diverges with the start values of every candidate.
  bool Step();
  double Progress() const;
  const std::string& status() const { return status_; }

  // The best model so far (the first candidate's softest start before there is any).
  ChosenModel Best() const;
  // The springs' own values (fit_model.h, SpringFactors) of that model, as the last round fitted
  // them; empty where there was none.
  const Eigen::VectorXd& BestSprings() const { return contenders_[BestContender()].springs; }

  void Save(StateArrays* arrays) const;
  void Load(const StateArrays& arrays);

 private:
  // A candidate on its way through the rounds, and where its optimiser is.
  struct Contender {
    ChosenModel model;
    double score;                 // of the last round it was in; infinite before
    bool finished = false;        // with this round
    int gain = 0, iteration = 0;  // gain: of kObserverGains
    double damping = 0, mean_square = 0;
    Eigen::VectorXd springs = {};  // in the last round
    std::string status = {};
  };

  const Recording& first() const { return data_.recordings[0]; }
  int BestContender() const;
  bool IsChainInRound() const;
  int LastGain(const Candidate& candidate) const;
  double PartOfRound(const Contender& contender) const;
  void StepContender(const TrainOptions& options, Contender* contender) const;
  void StepCommonFactors(const TrainOptions& options, Contender* contender) const;
  void StepSprings(const TrainOptions& options, Contender* contender) const;
  void FinishContender(const SpringMassSystem& system, Contender* contender) const;
  void BeginNextRound();
  void SearchStart(ChosenModel* model) const;
  double TrackError(const SpringMassSystem& system, const Candidate& candidate, double gain) const;

  const FitData& data_;
  TrainOptions options_;
  HeldBack held_back_;
  std::vector<Contender> contenders_;
  std::vector<int> in_round_;  // the contenders in the round: indices, ascending
  int round_ = 0;
  std::string status_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_MODEL_CHOICE_H_
