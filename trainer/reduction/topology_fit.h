// SPDX-License-Identifier: Apache-2.0
// Learns an assignment of the last level of a twin: trains the graph network's encoder so that
// Neural-CLASP (neural_clasp.h) on its latent features draws clusters whose Galerkin projection, as
// it is, predicts the fit frames under an observer (trainer/motion/observer.h). In each iteration a
// few draws are ranked by that error, and better ones made more likely than worse ones. The
// temperature falls from 1 to 0.1 in equal factors. The clusters of least error, among all that
// were drawn and the ones without noise at the end, are candidates.
#ifndef PHYSPRING_TRAINER_REDUCTION_TOPOLOGY_FIT_H_
#define PHYSPRING_TRAINER_REDUCTION_TOPOLOGY_FIT_H_

#include <cstdint>
#include <string>
#include <vector>

#include "trainer/motion/rollout.h"
#include "trainer/reduction/neural_clasp.h"
#include "trainer/reduction/reduction.h"
#include "twin/twin.h"

namespace physpring {

class TopologyFit {
 public:
  // Starts from the weights of `task`, whose data and network must outlive this.
  explicit TopologyFit(const ReductionTask& task);

  // One iteration, and whether it was the last.
  void Step();
  bool done() const;
  double Progress() const;
  const std::string& Status() const { return status_; }
  // What a journal keeps (journal/packing.h).
  template <class Visitor>
  void Visit(Visitor&& visit) {
    visit(iteration_, weights_, adam_mean_, adam_mean_square_, candidates_, errors_);
  }

  // The best assignments so far, all different, and the weights.
  const std::vector<Assignment>& candidates() const { return candidates_; }
  const Eigen::VectorXd& weights() const { return weights_; }

 private:
  double Temperature() const;
  double PredictionError(const Assignment& assignment) const;
  // The temperature is 0 in the last iteration. The gradient of the ranks' loss with respect to
  // `distance`.
  Eigen::VectorXd Draw(const Eigen::VectorXd& distance, double temperature);
  Eigen::VectorXd PositionDistances() const;
  void Learn(const Eigen::VectorXd& weights_bar);
  void Consider(const Assignment& assignment, double error);

  TrainOptions options_;
  Twin twin_;
  const GraphNetwork& network_;
  int nodes_;
  Eigen::Vector3d up_;
  std::vector<Episode> episodes_;
  const int most_substeps_;  // of a frame, of the levels that are drawn

  // Everything that the next step depends on, besides the above.
  int iteration_ = 0;
  Eigen::VectorXd weights_, adam_mean_, adam_mean_square_;
  std::vector<Assignment> candidates_;  // least error first ...
  std::vector<double> errors_;          // ... their errors, m
  std::string status_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_REDUCTION_TOPOLOGY_FIT_H_
