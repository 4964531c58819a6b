// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/material_estimate.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>

#include "trainer/bodies/factors.h"
#include "trainer/bodies/smooth_body.h"
#include "trainer/bodies/spring_classes.h"
#include "trainer/motion/residual_correlation.h"

namespace physpring {
namespace {

constexpr double kNinetyPercent = 1.645;                // standard deviations, on either side
constexpr double kMostDeviation = 10;                   // of a logarithm; more says nothing more
constexpr SpringClassOptions kReported{1.01, 6, true};  // the classes that are reported

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

class Estimator {
 public:
  Estimator(const SpringMassSystem& system, const Body& body, const std::vector<Episode>& episodes,
            const TrainOptions& options)
      : system_(system),
        recording_(OnlyFitFrames(episodes.at(0))),
        smooth_(system, recording_, *body.kind, {MostRate(options, recording_), true}),
        covariance_(Covariance(body, episodes, options)) {}

  // Of exp(log_value).
  Estimate Of(const LogValue& log_value) const;

 private:
  Eigen::MatrixXd Covariance(const Body& body, const std::vector<Episode>& episodes,
                             const TrainOptions& options) const;

  const SpringMassSystem& system_;
  Recording recording_;
  SmoothBody smooth_;
  Eigen::MatrixXd covariance_;  // of the smooth body's numbers
};

Eigen::MatrixXd Estimator::Covariance(const Body& body, const std::vector<Episode>& episodes,
                                      const TrainOptions& options) const {
  MotionProblem::Options follow = FollowOptions(recording_, body, options);
  follow.threads = 1;  // the differences run in parallel
  follow.keep_substeps = true;
  MotionProblem problem(SystemMap::OfResiduals([this](const Eigen::VectorXd& x) {
                          return smooth_.factors().Apply(x);
                        }),
                        episodes, follow);
  const int size = smooth_.size();
  const Eigen::VectorXd x = Eigen::VectorXd::Zero(size);
  Eigen::MatrixXd normal = smooth_.Precision();
  if (problem.FixSubsteps(x)) {
    if (const auto r = problem.Residuals(x)) {
      const Eigen::MatrixXd jacobian = DifferenceColumns(
          ResidualsOf(problem), x, *r, {0, size, FactorDifference(recording_), options.threads});
      const double variance = r->squaredNorm() / static_cast<double>(r->size()) *
                              ResidualCorrelationTime(system_, episodes, follow.rollout);
      normal += jacobian.transpose() * jacobian / std::max(variance, 1e-300);
    }
  }
  return normal.ldlt().solve(Eigen::MatrixXd::Identity(size, size));
}

Estimate Estimator::Of(const LogValue& log_value) const {
  constexpr double kDifference = 1e-6;
  const Eigen::VectorXd x = Eigen::VectorXd::Zero(smooth_.size());
  const double at = log_value(system_);
  Eigen::VectorXd slope(x.size());
  for (int i = 0; i < x.size(); ++i) {
    Eigen::VectorXd moved = x;
    moved[i] += kDifference;
    slope[i] = (log_value(smooth_.factors().Apply(moved)) - at) / kDifference;
  }
  const double deviation =
      std::min(kMostDeviation, std::sqrt(std::max(0.0, slope.dot(covariance_ * slope))));
  const double value = std::exp(at), reach = kNinetyPercent * deviation;
  return {value, value * std::max(0.0, 1 - reach), value * std::exp(reach)};
}

Material::Place PlaceOf(const Estimator& estimator, const Places& places,
                        const SpringMassSystem& system, std::ptrdiff_t node) {
  return {system.position.col(node), estimator.Of([&, node](const SpringMassSystem& moved) {
            return places.Of(moved)[static_cast<std::size_t>(node)];
          })};
}

}  // namespace

Material EstimateMaterial(const SpringMassSystem& system, const Body& body,
                          const std::vector<Episode>& episodes, const TrainOptions& options) {
  const Estimator estimator(system, body, episodes, options);
  Material material;
  Springs all;
  for (const Springs& springs : SpringsByLength(system)) {
    all.insert(all.end(), springs.begin(), springs.end());
    const auto [shortest, longest] = std::minmax_element(
        springs.begin(), springs.end(),
        [&](int i, int j) { return system.rest_length[i] < system.rest_length[j]; });
    material.classes.push_back({system.rest_length[*shortest], system.rest_length[*longest],
                                static_cast<int>(springs.size()),
                                estimator.Of([&](const SpringMassSystem& moved) {
                                  return std::log(std::max(1e-300, AxialStiffness(moved, springs)));
                                })});
  }
  material.loss_time = estimator.Of([&](const SpringMassSystem& moved) {
    return std::log(std::max(1e-300, moved.dashpot(all).sum() / moved.stiffness(all).sum()));
  });
  material.drag = estimator.Of(
      [](const SpringMassSystem& moved) { return std::log(std::max(1e-300, moved.drag)); });
  const Places places(system);
  const std::vector<double> factors = places.Of(system);
  const auto [softest, stiffest] = std::minmax_element(factors.begin(), factors.end());
  material.softest = PlaceOf(estimator, places, system, softest - factors.begin());
  material.stiffest = PlaceOf(estimator, places, system, stiffest - factors.begin());
  return material;
}

}  // namespace physpring
