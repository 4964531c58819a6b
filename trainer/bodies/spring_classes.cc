// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/spring_classes.h"

#include <algorithm>

namespace physpring {
namespace {

constexpr int kMostLengths = 10;  // of classes that jumps tell apart
constexpr double kWidest = 1.2;   // the longest spring of such a class, relative to its shortest
constexpr int kMostRanks = 40;    // of the springs of a controller, by nearness

std::vector<int> SortedByLength(const SpringMassSystem& system, std::vector<int> springs) {
  std::stable_sort(springs.begin(), springs.end(),
                   [&](int i, int j) { return system.rest_length[i] < system.rest_length[j]; });
  return springs;
}

void AddLengths(const SpringMassSystem& system, const std::vector<int>& springs,
                const SpringClassOptions& options, SpringClasses* classes) {
  const std::vector<int> sorted = SortedByLength(system, springs);
  int last = 0;
  double shortest = 0, widest = 1, before = 0;
  for (int e : sorted) {
    const double length = system.rest_length[e];
    const bool first = before == 0 || length > options.jump * before;
    if (first && before > 0) ++last;
    if (first) shortest = length;
    widest = std::max(widest, length / shortest);
    before = length;
    classes->of_spring[e] = last;
  }
  classes->irregular = last >= kMostLengths || widest > kWidest;
  if (classes->irregular) {
    const auto count = static_cast<long>(sorted.size());
    for (long i = 0; i < count; ++i) {
      last = static_cast<int>(i * options.equal / count);
      classes->of_spring[sorted[i]] = last;
    }
  }
  classes->count = classes->lengths = sorted.empty() ? 0 : last + 1;
}

void AddHands(const SpringMassSystem& system, const std::vector<int>& springs,
              SpringClasses* classes) {
  std::vector<int> of_controller(static_cast<std::size_t>(system.controllers), 0);
  int count = 0;
  for (int e : SortedByLength(system, springs)) {
    const int controller =
        std::max(system.springs[e][0], system.springs[e][1]) - system.node_count();
    const int rank = std::min(of_controller[controller]++, kMostRanks - 1);
    classes->of_spring[e] = classes->lengths + rank;
    count = std::max(count, rank + 1);
  }
  classes->count += count;
}

}  // namespace

SpringClasses ClassesOf(const SpringMassSystem& system, const SpringClassOptions& options) {
  std::vector<int> object, hands;
  for (int e = 0; e < system.spring_count(); ++e) {
    (options.hands_apart && system.IsControllerSpring(e) ? hands : object).push_back(e);
  }
  SpringClasses classes{std::vector<int>(static_cast<std::size_t>(system.spring_count()))};
  AddLengths(system, object, options, &classes);
  AddHands(system, hands, &classes);
  return classes;
}

SpringClasses OneClass(const SpringMassSystem& system) {
  return {std::vector<int>(static_cast<std::size_t>(system.spring_count()), 0), 1, 1};
}

}  // namespace physpring
