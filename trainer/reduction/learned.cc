// SPDX-License-Identifier: Apache-2.0
// The learned reduction: the encoder of the graph network learns which nodes to join
// (topology_fit.h). Its weights go on to the corrections of the level.
#include "trainer/reduction/reduction.h"
#include "trainer/reduction/topology_fit.h"

namespace physpring {
namespace {

class LearnedReduction : public Reduction {
 public:
  std::string name() const override { return "learned"; }
  std::string help() const override {
    return "near to each other in the features of the graph network (Neural-CLASP)";
  }
  bool LearnsFeatures() const override { return true; }

  Reduced Reduce(const ReductionTask& task, const Work& work) const override {
    const TopologyFit learned = work.Follow(TopologyFit(task), [](TopologyFit* fit) -> StepReport {
      fit->Step();
      return {fit->done(), fit->Progress(), fit->Status()};
    });
    return {learned.candidates(), learned.weights()};
  }
};

}  // namespace

std::unique_ptr<Reduction> MakeLearned() { return std::make_unique<LearnedReduction>(); }

}  // namespace physpring
