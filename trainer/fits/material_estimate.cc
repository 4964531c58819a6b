// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/material_estimate.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "trainer/bodies/factors.h"
#include "trainer/bodies/smooth_body.h"
#include "trainer/bodies/spring_classes.h"
#include "trainer/motion/motion_problem.h"
#include "trainer/solvers/levenberg_marquardt.h"

namespace physpring {
namespace {

constexpr double kNinetyPercent = 1.645;  // standard deviations, on either side
// Of made bodies of known material, the deviations as computed hold the truth in 55 % of the cases,
// and twice these in 89 % (docs/decisions/116-material-with-intervals.md): a twin's sub-steps are
// not those of the truth, and a fit ends a little beside the minimum.
constexpr double kWiden = 2;
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

// The part of J^T r of each fitted frame: parameters x frames, episode after episode.
std::vector<Eigen::MatrixXd> FrameScores(const std::vector<Episode>& episodes,
                                         const Eigen::MatrixXd& jacobian,
                                         const Eigen::VectorXd& r) {
  std::vector<Eigen::MatrixXd> scores;
  Eigen::Index row = 0;
  for (const Episode& episode : episodes) {
    Eigen::MatrixXd of_episode = Eigen::MatrixXd::Zero(jacobian.cols(), episode.frames);
    ForEachSeen(episode, FrameUse::kFit, [&](int frame, int /*point*/) {
      of_episode.col(frame) += jacobian.middleRows<3>(row).transpose() * r.segment<3>(row);
      row += 3;
    });
    scores.push_back(of_episode);
  }
  return scores;
}

// The covariance of the sum over frames, with Bartlett's weights for frames up to a quarter of all
// apart.
Eigen::MatrixXd LongRunCovariance(const std::vector<Eigen::MatrixXd>& scores) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(scores.at(0).rows(), scores[0].rows());
  for (const Eigen::MatrixXd& of_episode : scores) {
    const Eigen::Index frames = of_episode.cols(), reach = frames / 4;
    sum += of_episode * of_episode.transpose();
    for (Eigen::Index lag = 1; lag < reach; ++lag) {
      const double weight = 1 - static_cast<double>(lag) / static_cast<double>(reach);
      const Eigen::MatrixXd product =
          of_episode.rightCols(frames - lag) * of_episode.leftCols(frames - lag).transpose();
      sum += weight * (product + product.transpose());
    }
  }
  return sum;
}

class Estimator {
 public:
  Estimator(const SpringMassSystem& system, const Body& body, const std::vector<Episode>& episodes,
            const TrainOptions& options);

  // Of exp(log_value).
  Estimate Of(const LogValue& log_value) const;

 private:
  const SpringMassSystem& system_;
  Parameters numbers_;                      // of a smooth body
  Eigen::MatrixXd independent_, long_run_;  // covariances of the numbers
};

Estimator::Estimator(const SpringMassSystem& system, const Body& body,
                     const std::vector<Episode>& episodes, const TrainOptions& options)
    : system_(system),
      numbers_(SmoothBody(system, OnlyFitFrames(episodes.at(0)), *body.kind, {1, true}).factors()) {
  MotionProblem::Options follow = FollowOptions(*episodes[0].recording, body, options);
  follow.threads = 1;  // the differences run in parallel
  follow.keep_substeps = true;
  MotionProblem problem(
      SystemMap::OfResiduals([this](const Eigen::VectorXd& x) { return numbers_.Apply(x); }),
      episodes, follow);
  const int size = numbers_.size();
  const Eigen::VectorXd x = Eigen::VectorXd::Zero(size);
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(size, size);
  Eigen::MatrixXd normal = kLevenbergMarquardtPrecision * identity;
  Eigen::MatrixXd scores = Eigen::MatrixXd::Zero(size, size);
  const auto r = problem.FixSubsteps(x) ? problem.Residuals(x) : std::nullopt;
  if (r) {
    const double variance = std::max(r->squaredNorm() / static_cast<double>(r->size()), 1e-300);
    const double difference = FactorDifference(*episodes[0].recording);
    const Eigen::MatrixXd jacobian =
        DifferenceColumns(ResidualsOf(problem), x, *r, {0, size, difference, options.threads});
    normal += jacobian.transpose() * jacobian / variance;
    scores = LongRunCovariance(FrameScores(episodes, jacobian, *r)) / (variance * variance);
  }
  independent_ = normal.ldlt().solve(identity);
  long_run_ = independent_ * scores * independent_;
}

Estimate Estimator::Of(const LogValue& log_value) const {
  constexpr double kDifference = 1e-6;
  const Eigen::VectorXd x = Eigen::VectorXd::Zero(numbers_.size());
  const double at = log_value(system_);
  Eigen::VectorXd slope(x.size());
  for (int i = 0; i < x.size(); ++i) {
    Eigen::VectorXd moved = x;
    moved[i] += kDifference;
    slope[i] = (log_value(numbers_.Apply(moved)) - at) / kDifference;
  }
  const double variance = std::max(slope.dot(independent_ * slope), slope.dot(long_run_ * slope));
  const double deviation = std::min(kMostDeviation, std::sqrt(std::max(0.0, variance)));
  const double value = std::exp(at), reach = kNinetyPercent * kWiden * deviation;
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
