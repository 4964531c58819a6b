// SPDX-License-Identifier: Apache-2.0
#include "trainer/network/corrections_fit.h"

#include <cmath>
#include <limits>
#include <string>

namespace physpring {
namespace {

constexpr int kNetworkPatience = 5;  // epochs without gain on held-back frames
constexpr double kShorterSteps = 4;  // times, after turning back

void StoreAdam(const std::string& name, const Adam& adam, StateArrays* arrays) {
  const std::string prefix = "train/level/" + name + "_adam";
  (*arrays)[prefix + "/steps"] = StoreCounters({adam.steps});
  (*arrays)[prefix + "/mean"] = StoreVector(adam.mean);
  (*arrays)[prefix + "/mean_square"] = StoreVector(adam.mean_square);
}

void LoadAdam(const std::string& name, const StateArrays& arrays, Adam* adam) {
  const std::string prefix = "level/" + name + "_adam";
  adam->steps = LoadCounters(arrays, prefix + "/steps", 1)[0];
  adam->mean = LoadVector(arrays, prefix + "/mean", adam->mean.size());
  adam->mean_square = LoadVector(arrays, prefix + "/mean_square", adam->mean_square.size());
}

}  // namespace

CorrectionsFit::CorrectionsFit(const TrainOptions::Network& options, bool contact,
                               const Eigen::VectorXd& weights)
    : options_(options),
      updates_{options.updates, contact ? options.contact_updates : 0},
      weights_(weights),
      contact_(Eigen::VectorXd::Zero(2)),
      best_weights_(weights),
      best_contact_(contact_),
      weights_adam_(weights.size()),
      contact_adam_(contact_.size()),
      best_score_(std::numeric_limits<double>::infinity()) {}

bool CorrectionsFit::Judge(double score) {
  if (score < best_score_) {
    best_score_ = score;
    best_weights_ = weights_;
    best_contact_ = contact_;
    best_iteration_ = iteration_;
  }
  const bool worse = iteration_ - best_iteration_ >= kNetworkPatience * UpdatesPerEpoch();
  if (worse || iteration_ >= options_.epochs * UpdatesPerEpoch()) {
    weights_ = best_weights_;
    contact_ = best_contact_;
    return false;
  }
  ++iteration_;
  return true;
}

void CorrectionsFit::Update(const Eigen::VectorXd& gradient) {
  const int epoch = (iteration_ - 1) / UpdatesPerEpoch();
  const double slower = rate_ * std::pow(options_.decay, epoch);  // than at first
  const auto rates = [&](double rate) {
    return Eigen::VectorXd::Constant(gradient.size(), slower * rate);
  };
  if (is_turn_of_weights()) {
    weights_adam_.Step(gradient, rates(options_.learning_rate), &weights_);
  } else {
    contact_adam_.Step(gradient, rates(options_.contact_rate), &contact_);
  }
}

void CorrectionsFit::TurnBack() {
  weights_ = best_weights_;
  contact_ = best_contact_;
  rate_ /= kShorterSteps;
}

double CorrectionsFit::Progress() const {
  return static_cast<double>(iteration_) / (options_.epochs * UpdatesPerEpoch());
}

void CorrectionsFit::Save(bool learning, StateArrays* arrays) const {
  (*arrays)["train/level/best_weights"] = StoreVector(best_weights_);
  (*arrays)["train/level/best_contact"] = StoreVector(best_contact_);
  if (!learning) return;
  (*arrays)["train/level/corrections"] = StoreCounters({iteration_, best_iteration_});
  (*arrays)["train/level/learning"] = StoreVector(Eigen::Vector2d(best_score_, rate_));
  (*arrays)["train/level/weights"] = StoreVector(weights_);
  (*arrays)["train/level/contact"] = StoreVector(contact_);
  StoreAdam("weights", weights_adam_, arrays);
  StoreAdam("contact", contact_adam_, arrays);
}

void CorrectionsFit::Load(bool learning, const StateArrays& state) {
  weights_ = best_weights_ = LoadVector(state, "level/best_weights", weights_.size());
  contact_ = best_contact_ = LoadVector(state, "level/best_contact", contact_.size());
  if (!learning) return;
  const std::vector<int> counters = LoadCounters(state, "level/corrections", 2);
  iteration_ = counters[0];
  best_iteration_ = counters[1];
  const Eigen::VectorXd scalars = LoadVector(state, "level/learning", 2);
  best_score_ = scalars[0];
  rate_ = scalars[1];
  weights_ = LoadVector(state, "level/weights", weights_.size());
  contact_ = LoadVector(state, "level/contact", contact_.size());
  LoadAdam("weights", state, &weights_adam_);
  LoadAdam("contact", state, &contact_adam_);
}

}  // namespace physpring
