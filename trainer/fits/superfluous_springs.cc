// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/superfluous_springs.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "twin/checks/motion_scale.h"

namespace physpring {
namespace {

// A class is superfluous whose stiffness times length is below this part of the mean of all
// springs.
constexpr double kSuperfluous = 0.1;
// In an irregular mesh the object's springs end at one length. A class beside it that has less than
// this part of what is typical is more likely beyond than within; so is a single spring.
constexpr double kBeyond = 0.25, kSpringBeyond = 0.5;
constexpr double kJustBelow = 1 - 1e-9;  // a length: as long but for rounding is beyond, too
constexpr int kFineClass = 4;            // springs

// Of each class, the mean stiffness times length, N, and the number of springs.
struct ClassMeans {
  std::vector<double> axial, count;

  ClassMeans(const SpringMassSystem& system, const SpringClasses& classes)
      : axial(static_cast<std::size_t>(classes.count), 0), count(axial) {
    for (int e = 0; e < system.spring_count(); ++e) {
      axial[classes.of_spring[e]] += system.stiffness[e] * system.rest_length[e];
      count[classes.of_spring[e]] += 1;
    }
    for (std::size_t i = 0; i < axial.size(); ++i) axial[i] /= std::max(1.0, count[i]);
  }
};

// N: the median of the springs that carry something.
double TypicalAxial(const SpringMassSystem& system) {
  const Eigen::VectorXd axial = system.stiffness.cwiseProduct(system.rest_length);
  std::vector<double> carrying;
  for (double one : axial) {
    if (one >= kSuperfluous * axial.mean()) carrying.push_back(one);
  }
  return Median(std::move(carrying));
}

// The last class of length within the object, of an irregular mesh: as if its springs had all what
// is typical up to one length, and nothing beyond.
int LastWithin(const ClassMeans& means, double typical, const SpringClasses& classes,
               double least) {
  int last = -1;
  double sum = 0, most = 0;
  for (int i = 0; i < classes.lengths; ++i) {
    sum += means.count[i] * (std::min(1.0, means.axial[i] / typical) - least);
    if (sum <= most) continue;
    most = sum;
    last = i;
  }
  return last;
}

// Which classes stay, and how the end of an irregular mesh's springs is cut from now on: it is in
// the last class within, or in the next one, which stays for that. They are cut into finer classes,
// and these into single springs.
struct Kept {
  std::vector<bool> classes;
  SpringClassOptions::Finer finer;
};

Kept WhatStays(const SpringMassSystem& system, const SpringClasses& classes,
               const SpringClassOptions::Finer& finer) {
  const ClassMeans means(system, classes);
  const double mean = system.stiffness.cwiseProduct(system.rest_length).mean();
  Kept kept{{}, finer};
  for (double axial : means.axial) kept.classes.push_back(axial >= kSuperfluous * mean);
  if (!classes.irregular) return kept;
  const bool single = finer.springs == 1;
  const int last =
      LastWithin(means, TypicalAxial(system), classes, single ? kSpringBeyond : kBeyond);
  const bool seen = last + 1 < classes.lengths;
  for (int i = 0; i < classes.lengths; ++i) kept.classes[i] = i <= last + (single ? 0 : 1);
  if (single || last < 0 || (finer.springs == 0 && !seen)) return kept;
  double shortest = kInfinity;
  for (int e = 0; e < system.spring_count(); ++e) {
    if (classes.of_spring[e] == last) shortest = std::min(shortest, system.rest_length[e]);
  }
  kept.finer = {kJustBelow * shortest, finer.springs == 0 ? kFineClass : 1};
  return kept;
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

// As fitted, but for the field: where the whole object is soft, a spring carries no less.
SpringMassSystem WithoutField(const SmoothlyFitted& fit) {
  const Parameters& factors = fit.body.factors();
  Eigen::VectorXd x = fit.x;
  for (int i = 0; i < factors.size(); ++i) {
    if (factors.kind(i) == Parameters::Kind::kMode) x[i] = 0;
  }
  return factors.Apply(x);
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
  const Kept stays = WhatStays(WithoutField(fit), factors.classes(), fit.body.options().finer);
  SmoothBody::Options options = fit.body.options();
  options.finer = stays.finer;
  if (factors.classes().irregular) options.hands_apart = true;
  std::vector<int> kept;
  for (int e = 0; e < system.spring_count(); ++e) {
    if (stays.classes[factors.classes().of_spring[e]]) kept.push_back(e);
  }
  const bool all = static_cast<int>(kept.size()) == system.spring_count();
  if (all && options.finer == fit.body.options().finer) return {};
  const SpringMassSystem base = OnlySprings(factors.base(), kept);
  if (!HoldsTogether(factors.base(), base)) return {};
  const SmoothBody body(base, recording, kind, options);
  return SmoothlyFitted{body, body.NumbersLike(OnlySprings(system, kept), fit.x)};
}

}  // namespace physpring
