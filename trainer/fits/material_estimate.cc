// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/material_estimate.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "trainer/bodies/spring_classes.h"

namespace physpring {
namespace {

constexpr double kNinetyPercent = 1.645;  // standard deviations, on either side
constexpr double kMostDeviation = 10;     // of a logarithm; more says nothing more
// the classes that are reported
constexpr SpringClassOptions kReported{.jump = 1.01, .equal = 6, .hands_apart = true};

using Springs = std::vector<int>;
using LogValue = std::function<double(const SpringMassSystem&)>;

// The mean of stiffness times length, N.
double AxialStiffness(const SpringMassSystem& system, const Springs& springs) {
  double sum = 0;
  for (int e : springs) sum += system.stiffness[e] * system.rest_length[e];
  return sum / static_cast<double>(springs.size());
}

// Springs between nodes, by class of length.
std::vector<Springs> SpringsByLength(const SpringMassSystem& system) {
  const SpringClasses classes = ClassesOf(system, kReported);
  std::vector<Springs> springs(static_cast<std::size_t>(classes.lengths));
  for (int e = 0; e < system.spring_count(); ++e) {
    if (!system.IsControllerSpring(e)) springs[classes.of_spring[e]].push_back(e);
  }
  return springs;
}

// How soft or stiff the springs at each node are: stiffness relative to springs of their lengths, a
// logarithm. It weighs springs by stiffness: weak ones say little of a place.
class Places {
 public:
  explicit Places(const SpringMassSystem& system)
      : by_length_(SpringsByLength(system)),
        at_node_(static_cast<std::size_t>(system.node_count())),
        class_of_(static_cast<std::size_t>(system.spring_count()), 0),
        weight_(system.stiffness.cwiseProduct(system.rest_length)) {
    for (std::size_t c = 0; c < by_length_.size(); ++c) {
      for (int e : by_length_[c]) {
        class_of_[e] = static_cast<int>(c);
        for (int end : system.springs[e]) at_node_[end].push_back(e);
      }
    }
  }

  std::vector<double> Of(const SpringMassSystem& system) const {
    std::vector<double> class_mean;
    for (const Springs& springs : by_length_) class_mean.push_back(AxialStiffness(system, springs));
    std::vector<double> factors;
    for (const Springs& springs : at_node_) {
      double sum = 0, weight = 0;
      for (int e : springs) {
        const double stiffness = system.stiffness[e] * system.rest_length[e];
        sum += weight_[e] * std::log(std::max(1e-300, stiffness / class_mean[class_of_[e]]));
        weight += weight_[e];
      }
      factors.push_back(weight > 0 ? sum / weight : 0);
    }
    return factors;
  }

 private:
  std::vector<Springs> by_length_, at_node_;
  std::vector<int> class_of_;
  Eigen::VectorXd weight_;  // as first given
};

class Intervals {
 public:
  Intervals(const SpringMassSystem& system, const Posterior& posterior) : system_(system) {
    for (int i = 0; i < posterior.size(); ++i) {
      moved_.push_back(
          MovedAlong(posterior, system, kDifference * Eigen::VectorXd::Unit(posterior.size(), i)));
    }
  }

  // Of exp(log_value).
  Estimate Of(const LogValue& log_value) const {
    const double at = log_value(system_);
    double variance = 0;
    for (const SpringMassSystem& moved : moved_) {
      variance += std::pow((log_value(moved) - at) / kDifference, 2);
    }
    const double value = std::exp(at);
    const double reach = kNinetyPercent * std::min(kMostDeviation, std::sqrt(variance));
    return {value, value * std::max(0.0, 1 - reach), value * std::exp(reach)};
  }

 private:
  static constexpr double kDifference = 1e-6;  // standard deviations
  const SpringMassSystem& system_;
  std::vector<SpringMassSystem> moved_;  // along each direction of the posterior
};

Material::Place PlaceOf(const Intervals& intervals, const Places& places,
                        const SpringMassSystem& system, std::ptrdiff_t node) {
  return {system.position.col(node), intervals.Of([&, node](const SpringMassSystem& moved) {
            return places.Of(moved)[static_cast<std::size_t>(node)];
          })};
}

}  // namespace

Material EstimateMaterial(const SpringMassSystem& system, const Posterior& posterior) {
  const Intervals intervals(system, posterior);
  Material material;
  Springs all;
  for (const Springs& springs : SpringsByLength(system)) {
    all.insert(all.end(), springs.begin(), springs.end());
    const auto [shortest, longest] = std::minmax_element(
        springs.begin(), springs.end(),
        [&](int i, int j) { return system.rest_length[i] < system.rest_length[j]; });
    material.classes.push_back({system.rest_length[*shortest], system.rest_length[*longest],
                                static_cast<int>(springs.size()),
                                intervals.Of([&](const SpringMassSystem& moved) {
                                  return std::log(std::max(1e-300, AxialStiffness(moved, springs)));
                                })});
  }
  material.loss_time = intervals.Of([&](const SpringMassSystem& moved) {
    return std::log(std::max(1e-300, moved.dashpot(all).sum() / moved.stiffness(all).sum()));
  });
  material.drag = intervals.Of(
      [](const SpringMassSystem& moved) { return std::log(std::max(1e-300, moved.drag)); });
  const Places places(system);
  const std::vector<double> factors = places.Of(system);
  const auto [softest, stiffest] = std::minmax_element(factors.begin(), factors.end());
  material.softest = PlaceOf(intervals, places, system, softest - factors.begin());
  material.stiffest = PlaceOf(intervals, places, system, stiffest - factors.begin());
  return material;
}

}  // namespace physpring
