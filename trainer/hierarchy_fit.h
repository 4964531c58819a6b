// SPDX-License-Identifier: Apache-2.0
// The fit of a whole twin, one level after the other: level 0 by another fitter, then for each
// coarser level an assignment (trainer/reduction), the Galerkin projection of the level below, and
// the fit of its parameters (level_fit.h). A level that is done does not change any more. Of a
// learned reduction's candidates the one is taken whose common factors predict the recordings best
// under an observer.
#ifndef PHYSPRING_TRAINER_HIERARCHY_FIT_H_
#define PHYSPRING_TRAINER_HIERARCHY_FIT_H_

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "trainer/fitter.h"
#include "trainer/level_fit.h"
#include "trainer/network/graph_network.h"
#include "trainer/reduction/topology_fit.h"
#include "trainer/train_options.h"

namespace physpring {

class HierarchyFit : public Fitter {
 public:
  // `dense` fits level 0 to the same data. Throws Error if a level would have no fewer nodes than
  // the one below it, or no spring.
  HierarchyFit(FitData data, const TrainOptions& options, std::unique_ptr<Fitter> dense);

  bool Step() override;
  double Progress() const override;
  std::string Status() const override { return status_; }
  std::string Part() const override;
  StateArrays Save() const override;
  void Load(const StateArrays& state) override;
  Twin Result() const override;

 private:
  // The next level with one of the assignments that it may have.
  struct Trial {
    std::vector<int> assignment;
    LevelFit level;
    Trial(std::vector<int> members, LevelFit fit)
        : assignment(std::move(members)), level(std::move(fit)) {}
  };

  int NodesOfNextLevel() const;
  void BeginReduction();
  void BeginTrials(const std::vector<std::vector<int>>& candidates);
  void StepTrials();
  void FinishLevel();
  void SaveTrials(StateArrays* arrays) const;
  void LoadTrials(const StateArrays& state, int count);
  std::vector<int> LoadAssignment(const StateArrays& state, const std::string& name) const;
  Twin WithNextLevel(const std::vector<int>& assignment) const;
  int done() const { return static_cast<int>(twin_.levels.size()); }

  FitData data_;
  TrainOptions options_;
  std::unique_ptr<Fitter> dense_;
  GraphNetwork network_;
  Eigen::VectorXd weights_;  // as the last level left them
  Twin twin_;                // the levels that are done
  // The next one: its assignment is learned, if it is; of several the one whose common factors can
  // be fitted best is left; that is fitted on.
  std::optional<TopologyFit> topology_;
  std::vector<std::unique_ptr<Trial>> trials_;
  std::string status_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_HIERARCHY_FIT_H_
