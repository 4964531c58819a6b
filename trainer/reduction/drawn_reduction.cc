// SPDX-License-Identifier: Apache-2.0
#include "trainer/reduction/drawn_reduction.h"

#include <fmt/format.h>

namespace physpring {
namespace {

// What the journal keeps.
struct Drawn {
  Assignment assignment;

  template <class Visitor>
  void Visit(Visitor&& visit) {
    visit(assignment);
  }
};

}  // namespace

Reduced DrawnReduction::Reduce(const ReductionTask& task, const Work& work) const {
  const std::uint64_t level = task.twin.levels.size();
  const std::uint64_t seed = task.options.seed * 1000 + level;
  const auto draw = [&](Drawn* drawn) -> StepReport {
    drawn->assignment = Draw(task.twin.levels.back().system, task.nodes, seed);
    return {true, 1, fmt::format("level {}: {} nodes", level, task.nodes)};
  };
  return {{work.Follow(Drawn(), draw).assignment}, task.weights};
}

}  // namespace physpring
