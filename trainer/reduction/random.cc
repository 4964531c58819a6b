// SPDX-License-Identifier: Apache-2.0
// A random subset of the nodes become roots; each other node goes to the nearest of them through
// springs.
#include "trainer/reduction/drawn_reduction.h"

namespace physpring {
namespace {

class RandomReduction : public DrawnReduction {
 public:
  std::string name() const override { return "random"; }
  std::string help() const override {
    return "a random subset of the nodes, each with the nodes nearest to it through springs";
  }

 private:
  Assignment Draw(const SpringMassSystem& system, int nodes, std::uint64_t seed) const override {
    const SpringGraph graph(system);
    std::mt19937_64 random(seed);
    const std::vector<int> order = Shuffled(graph.node_count(), &random);
    return GrowFromRoots(graph,
                         FirstOfEachPartThenOthers(graph, order, ClusterBudget(graph, nodes)));
  }
};

}  // namespace

std::unique_ptr<Reduction> MakeRandom() { return std::make_unique<RandomReduction>(); }

}  // namespace physpring
