// SPDX-License-Identifier: Apache-2.0
// A search at the end of the fit of a chain (bodies/bending_chain.h). CMA-ES makes the geometric
// mean of the track errors of free motions small. It moves those of the common factors that are one
// value for the whole body, from where Levenberg-Marquardt left them. The motions of a cable that
// whirls are chaotic. Differences and adjoints of them tell little of where better factors are, and
// their squares are those of a few frames in which the cable lost its phase. The shape of the rod
// stays: that is seen under an observer.
#ifndef PHYSPRING_TRAINER_FITS_FREE_MOTION_SEARCH_H_
#define PHYSPRING_TRAINER_FITS_FREE_MOTION_SEARCH_H_

#include <cstdint>
#include <vector>

#include "trainer/bodies/chosen_body.h"
#include "trainer/solvers/cma_es.h"

namespace physpring {

class FreeMotionSearch {
 public:
  // Starts from `factors`, whose `entries` move. Makes `generations` generations; if that is 0, as
  // many as gain something.
  FreeMotionSearch(const Eigen::VectorXd& factors, const std::vector<int>& entries, int generations,
                   std::uint64_t seed);

  bool done() const;
  double Progress() const;

  // Makes one generation of factors of `model`. The result does not depend on options.threads.
  void Step(const ChosenBody& model, const std::vector<Episode>& episodes,
            const TrainOptions& options);

  Eigen::VectorXd BestFactors() const { return FactorsAt(search_.state().best); }
  double best_error() const { return search_.state().best_objective; }  // m

  // What a journal keeps (journal/packing.h).
  template <class Visitor>
  void Visit(Visitor&& visit) {
    visit(start_, search_, gained_error_, slow_);
  }

 private:
  Eigen::VectorXd FactorsAt(const Eigen::VectorXd& point) const;

  Eigen::VectorXd start_;
  std::vector<int> entries_;
  int generations_;  // 0: as long as they gain something
  CmaEs search_;
  double gained_error_;  // the best error when it last fell by more than little, m
  int slow_ = 0;         // generations since then
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_FREE_MOTION_SEARCH_H_
