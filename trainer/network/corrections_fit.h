// SPDX-License-Identifier: Apache-2.0
// The learning of a coarse level's corrections by Adam: epochs of updates of the network's weights,
// each followed by updates of the contact's coefficients alone (the paper's K_model and K_col). The
// values that predict held-back frames best count. Whoever uses it computes scores and gradients:
//   while (fit.Judge(score of fit.weights(), fit.contact())) fit.Update(gradient);
#ifndef PHYSPRING_TRAINER_NETWORK_CORRECTIONS_FIT_H_
#define PHYSPRING_TRAINER_NETWORK_CORRECTIONS_FIT_H_

#include <Eigen/Core>

#include "trainer/data/train_options.h"
#include "trainer/solvers/adam.h"

namespace physpring {

class CorrectionsFit {
 public:
  // Starts from these weights and an unchanged contact. `contact` says whether there is one.
  CorrectionsFit(const TrainOptions::Network& options, bool contact,
                 const Eigen::VectorXd& weights);

  // What is tried: the network's weights, and what is added to the logits of the ground's
  // coefficients of contact.
  const Eigen::VectorXd& weights() const { return weights_; }
  const Eigen::VectorXd& contact() const { return contact_; }
  const Eigen::VectorXd& best_weights() const { return best_weights_; }
  const Eigen::VectorXd& best_contact() const { return best_contact_; }

  // `score` is the track error on held-back frames of what is tried, m. Returns false at the end:
  // all epochs are done, or several brought nothing. Then the best is what is tried.
  bool Judge(double score);

  // Whether the next update is one of the weights; else it is one of the contact.
  bool is_turn_of_weights() const { return (iteration_ - 1) % UpdatesPerEpoch() < updates_.model; }
  // Update takes d loss / d weights, or d loss / d contact. TurnBack takes its place where there is
  // no loss: it goes back to the best, and from there on in shorter steps.
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
    int model, contact;  // how many make an epoch
  };

  int UpdatesPerEpoch() const { return updates_.model + updates_.contact; }

  TrainOptions::Network options_;
  Updates updates_;
  Eigen::VectorXd weights_, contact_, best_weights_, best_contact_;
  Adam weights_adam_, contact_adam_;
  double best_score_;  // m
  int iteration_ = 0, best_iteration_ = 0;
  double rate_ = 1;  // the learning rate, relative to the options'
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_NETWORK_CORRECTIONS_FIT_H_
