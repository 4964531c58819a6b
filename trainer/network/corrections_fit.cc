// SPDX-License-Identifier: Apache-2.0
#include "trainer/network/corrections_fit.h"

#include <cmath>
#include <limits>

#include "twin/contact_law.h"

namespace physpring {
namespace {

constexpr int kNetworkPatience = 5;  // epochs without gain on held-back frames
constexpr double kShorterSteps = 4;  // steps are so many times shorter after turning back

}  // namespace

CorrectionsFit::CorrectionsFit(const TrainOptions::Network& options, bool contact,
                               const Eigen::VectorXd& weights)
    : options_(options),
      updates_{options.updates, contact ? options.contact_updates : 0},
      weights_(weights),
      contact_(Eigen::VectorXd::Zero(kContactCount)),
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
  // relative to the options' rate
  const double slower = rate_ * std::pow(options_.decay, epoch);
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

}  // namespace physpring
