// SPDX-License-Identifier: Apache-2.0
// A reduction chooses which nodes of a level become one node of the next coarser level. To add one:
// its file in this folder, and its lines in registry.cc and trainer/CMakeLists.txt. Most only look
// at the level and derive from DrawnReduction (drawn_reduction.h). One that learns does so step by
// step, as work that a journal keeps (journal/work.h).
#ifndef PHYSPRING_TRAINER_REDUCTION_REDUCTION_H_
#define PHYSPRING_TRAINER_REDUCTION_REDUCTION_H_

#include <memory>
#include <string>
#include <vector>

#include "trainer/data/fit_data.h"
#include "trainer/data/train_options.h"
#include "trainer/journal/work.h"
#include "trainer/network/graph_network.h"
#include "trainer/projection/assignment.h"
#include "twin/twin.h"

namespace physpring {

// What is to be reduced, and what a reduction may look at. It only refers to what it is made of.
struct ReductionTask {
  const Twin& twin;  // to its last level a coarser one is added ...
  int nodes;         // ... of so many nodes, or as near to it as the body's parts allow
  Eigen::Vector3d up;
  const FitData& data;
  const TrainOptions& options;
  const GraphNetwork& network;
  const Eigen::VectorXd& weights;  // of the network, as the last level left them
};

struct Reduced {
  std::vector<Assignment> candidates;  // the fit of the level chooses among them
  Eigen::VectorXd weights;             // of the network, from which it goes on
};

class Reduction {
 public:
  virtual ~Reduction() = default;

  // As users type it.
  virtual std::string name() const = 0;
  // Which nodes become one, in a few words.
  virtual std::string help() const = 0;
  // Whether it learns features, so that TrainOptions::Network::features means something.
  virtual bool LearnsFeatures() const { return false; }

  virtual Reduced Reduce(const ReductionTask& task, const Work& work) const = 0;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_REDUCTION_REDUCTION_H_
