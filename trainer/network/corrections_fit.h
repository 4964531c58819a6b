// SPDX-License-Identifier: Apache-2.0
// The learning of a coarse level's corrections by Adam: epochs of updates of the network's weights,
// each followed by updates of the contact's coefficients alone (the paper's K_model and K_col).
// What predicts held-back frames best counts. Whoever uses it computes scores and gradients:
//   while (fit.Judge(score of fit.weights(), fit.contact())) fit.Update(gradient);
#ifndef PHYSPRING_TRAINER_NETWORK_CORRECTIONS_FIT_H_
#define PHYSPRING_TRAINER_NETWORK_CORRECTIONS_FIT_H_

#include <Eigen/Core>

#include "trainer/data/train_options.h"
#include "trainer/solvers/adam.h"

namespace physpring {

class CorrectionsFit {
 public:
  // From these weights and an unchanged contact. `contact`: whether there is one.
  CorrectionsFit(const TrainOptions::Network& options, bool contact,
                 const Eigen::VectorXd& weights);

  // What is tried: the network's weights, and what is added to the logits of the ground's
  // restitution and friction.
  const Eigen::VectorXd& weights() const { return weights_; }
  const Eigen::VectorXd& contact() const { return contact_; }
  const Eigen::VectorXd& best_weights() const { return best_weights_; }
  const Eigen::VectorXd& best_contact() const { return best_contact_; }

  // With the track error on held-back frames of what is tried, m. False at the end: all epochs are
  // done, or several brought nothing; then the best is what is tried.
  bool Judge(double score);

  // Whose turn the update is that follows: of the weights, or else of the contact.
  bool is_turn_of_weights() const { return (iteration_ - 1) % UpdatesPerEpoch() < updates_.model; }
  // d loss / d weights or contact; TurnBack where there is no loss: to the best, on in shorter
  // steps.
  void Update(const Eigen::VectorXd& gradient);
  void TurnBack();

  double Progress() const;  // 0 ... 1

  // What a journal keeps (journal/packing.h).
  template <class Visitor>
  void Visit(Visitor&& visit) {
    visit(weights_, contact_, best_weights_, best_contact_, weights_adam_, contact_adam_,
          best_score_, iteration_, best_iteration_, rate_);
  }

 private:
  struct Updates {
    int model, contact;  // in an epoch
  };

  int UpdatesPerEpoch() const { return updates_.model + updates_.contact; }

  TrainOptions::Network options_;
  Updates updates_;
  Eigen::VectorXd weights_, contact_, best_weights_, best_contact_;
  Adam weights_adam_, contact_adam_;
  double best_score_;  // m
  int iteration_ = 0, best_iteration_ = 0;
  double rate_ = 1;  // of learning, relative to the options'
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_NETWORK_CORRECTIONS_FIT_H_
