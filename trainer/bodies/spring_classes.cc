// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/spring_classes.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace physpring {
namespace {

constexpr int kMostLengths = 10;     // of classes that jumps tell apart
constexpr double kWidest = 1.2;      // the longest spring of such a class, relative to its shortest
constexpr int kMostDirections = 60;  // of all lengths together
constexpr double kParallel = 0.98;   // the least cosine between springs of one direction
constexpr int kMostRanks = 40;       // of the springs of a controller, by nearness

std::vector<int> SortedByLength(const SpringMassSystem& system, std::vector<int> springs) {
  std::stable_sort(springs.begin(), springs.end(),
                   [&](int i, int j) { return system.rest_length[i] < system.rest_length[j]; });
  return springs;
}

Eigen::Vector3d DirectionOf(const SpringMassSystem& system, int spring) {
  const auto [a, b] = system.springs[spring];
  return (system.position.col(b) - system.position.col(a)).normalized();
}

// Cuts the classes of these springs, which are in the order of length, into those of one direction
// each. Nothing changes where that would give too many.
void CutByDirection(const SpringMassSystem& system, const std::vector<int>& sorted,
                    SpringClasses* classes) {
  std::vector<int> first_of;  // of each new class the first spring
  std::vector<bool> like_the_last;
  std::vector<int> made(sorted.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const int e = sorted[i];
    const auto same = std::find_if(first_of.begin(), first_of.end(), [&](int other) {
      return classes->of_spring[other] == classes->of_spring[e] &&
             std::abs(DirectionOf(system, other).dot(DirectionOf(system, e))) > kParallel;
    });
    made[i] = static_cast<int>(same - first_of.begin());
    if (same != first_of.end()) continue;
    like_the_last.push_back(!first_of.empty() &&
                            classes->of_spring[first_of.back()] == classes->of_spring[e]);
    first_of.push_back(e);
    if (first_of.size() > kMostDirections) return;
  }
  for (std::size_t i = 0; i < sorted.size(); ++i) classes->of_spring[sorted[i]] = made[i];
  classes->like_the_last = std::move(like_the_last);
  classes->count = classes->lengths = static_cast<int>(first_of.size());
}

// Cuts these springs, which are in the order of length, into equally filled classes. Returns the
// last one.
int CutEqually(const SpringMassSystem& system, const std::vector<int>& sorted,
               const SpringClassOptions& options, SpringClasses* classes) {
  const auto longer = std::find_if(sorted.begin(), sorted.end(), [&](int e) {
    return system.rest_length[e] > options.finer.beyond;
  });
  const auto count = static_cast<long>(sorted.size()), coarse = longer - sorted.begin();
  int last = -1;
  for (long i = 0, of_last = -1; i < count; ++i) {
    const bool fine = i >= coarse;
    const long one =
        fine ? options.equal + (i - coarse) / options.finer.springs : i * options.equal / count;
    if (one != of_last) ++last;
    of_last = one;
    classes->of_spring[sorted[i]] = last;
  }
  return last;
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
    last = CutEqually(system, sorted, options, classes);
  }
  classes->count = classes->lengths = sorted.empty() ? 0 : last + 1;
  classes->like_the_last.assign(static_cast<std::size_t>(classes->lengths), classes->irregular);
  if (options.directions && !classes->irregular) CutByDirection(system, sorted, classes);
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
