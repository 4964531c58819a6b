// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/superfluous_springs.h"

#include <algorithm>
#include <vector>

namespace physpring {
namespace {

// A class is superfluous whose stiffness times length is below this part of the mean of all
// springs.
constexpr double kSuperfluous = 0.1;

// Whether a class of springs carries something.
std::vector<bool> Carries(const SpringMassSystem& system, const SpringClasses& classes) {
  const Eigen::VectorXd axial = system.stiffness.cwiseProduct(system.rest_length);
  std::vector<double> sum(static_cast<std::size_t>(classes.count), 0), count = sum;
  for (int e = 0; e < system.spring_count(); ++e) {
    sum[classes.of_spring[e]] += axial[e];
    count[classes.of_spring[e]] += 1;
  }
  std::vector<bool> carries;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    carries.push_back(sum[i] >= kSuperfluous * axial.mean() * count[i]);
  }
  return carries;
}

SpringMassSystem OnlySprings(const SpringMassSystem& system, const std::vector<int>& kept) {
  SpringMassSystem some = system;
  some.springs.clear();
  for (int e : kept) some.springs.push_back(system.springs[static_cast<std::size_t>(e)]);
  some.stiffness = system.stiffness(kept);
  some.rest_length = system.rest_length(kept);
  some.dashpot = system.dashpot(kept);
  return some;
}

// Whether every node still has two springs, if it had them, and every controller one.
bool HoldsTogether(const SpringMassSystem& before, const SpringMassSystem& after) {
  constexpr int kLeast = 2;
  const auto degrees = [](const SpringMassSystem& system) {
    std::vector<int> degree(static_cast<std::size_t>(system.position.cols()), 0);
    for (const auto& [a, b] : system.springs) {
      ++degree[static_cast<std::size_t>(a)];
      ++degree[static_cast<std::size_t>(b)];
    }
    return degree;
  };
  const std::vector<int> old_degree = degrees(before), degree = degrees(after);
  for (std::size_t i = 0; i < degree.size(); ++i) {
    const int least = static_cast<int>(i) < before.node_count() ? kLeast : 1;
    if (degree[i] < std::min(least, old_degree[i])) return false;
  }
  return true;
}

}  // namespace

std::optional<SmoothlyFitted> WithoutSuperfluousSprings(const SmoothlyFitted& fit,
                                                        const Recording& recording,
                                                        const BodyKind& kind) {
  const Parameters& factors = fit.body.factors();
  const SpringMassSystem system = factors.Apply(fit.x);
  const std::vector<bool> carries = Carries(system, factors.classes());
  std::vector<int> kept;
  for (int e = 0; e < system.spring_count(); ++e) {
    if (carries[factors.classes().of_spring[e]]) kept.push_back(e);
  }
  if (static_cast<int>(kept.size()) == system.spring_count()) return {};
  const SpringMassSystem base = OnlySprings(factors.base(), kept);
  if (!HoldsTogether(factors.base(), base)) return {};
  const SmoothBody body(base, recording, kind, fit.body.options());
  return SmoothlyFitted{body, body.NumbersLike(OnlySprings(system, kept), fit.x)};
}

}  // namespace physpring
