// SPDX-License-Identifier: Apache-2.0
#include "trainer/reduction/topology_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "trainer/data/held_back.h"
#include "trainer/motion/lifted_motion.h"
#include "trainer/motion/track_error.h"
#include "trainer/network/level_network.h"
#include "trainer/projection/galerkin.h"
#include "trainer/projection/soften_level.h"
#include "trainer/solvers/adam.h"
#include "twin/parallel.h"

namespace physpring {
namespace {

constexpr int kIterations = 40;
constexpr int kTopologyDraws = 6;  // an iteration
constexpr double kHottest = 1, kColdest = 0.1;
constexpr std::size_t kCandidates = 3;
constexpr int kMostRecordings = 4;
constexpr double kDrawGain = 0.1;  // of the observer
constexpr double kDiverged = 1e3;  // m, the error of a level that diverges

}  // namespace

TopologyFit::TopologyFit(const ReductionTask& task)
    : options_(task.options),
      twin_(task.twin),
      network_(task.network),
      nodes_(task.nodes),
      up_(task.up),
      episodes_(FitEpisodes(task.data, kMostRecordings)),
      most_substeps_(MostSubstepsOfLevels(twin_.levels[0], episodes_.at(0).recording->fps)),
      weights_(task.weights),
      adam_mean_(Eigen::VectorXd::Zero(task.weights.size())),
      adam_mean_square_(adam_mean_) {}

// The mean track error, m, in single precision: for a choice that is enough.
double TopologyFit::PredictionError(const Assignment& assignment) const {
  Twin twin = twin_;
  twin.levels.push_back(
      {Project(twin_.levels.back().system, assignment, up_).system, assignment, 0});
  SpringMassSystem& system = twin.levels.back().system;
  if (options_.substeps == 0) SoftenLevel(most_substeps_, episodes_[0].recording->fps, &system);
  LiftedMotion::Options options;
  options.rollout.single_precision = true;
  options.rollout.controller_velocity = twin.controller_velocity;
  options.rollout.substeps = options_.substeps;
  options.rollout.observer_gain = kDrawGain;
  options.most_substeps = std::numeric_limits<int>::max();
  const LiftedMotion level(twin, static_cast<int>(twin_.levels.size()), episodes_, options);
  const auto moved = level.Run(system, level.SubstepsOf(system));
  if (!moved) return kDiverged;
  double sum = 0;
  for (int e = 0; e < level.episode_count(); ++e) {
    sum += MeanTrackError(level.episode(e), FrameUse::kFit, (*moved)[e].particles());
  }
  return sum / level.episode_count();
}

void TopologyFit::Consider(const Assignment& assignment, double error) {
  if (std::find(candidates_.begin(), candidates_.end(), assignment) != candidates_.end()) return;
  const auto place = std::upper_bound(errors_.begin(), errors_.end(), error) - errors_.begin();
  errors_.insert(errors_.begin() + place, error);
  candidates_.insert(candidates_.begin() + place, assignment);
  if (candidates_.size() > kCandidates) {
    errors_.pop_back();
    candidates_.pop_back();
  }
}

double TopologyFit::Temperature() const {
  const double part = static_cast<double>(iteration_) / (kIterations - 1);
  return kHottest * std::pow(kColdest / kHottest, part);
}

Eigen::VectorXd TopologyFit::Draw(const Eigen::VectorXd& distance, double temperature) {
  const SpringMassSystem& system = twin_.levels.back().system;
  std::mt19937_64 random(options_.seed * 1000003 + 1009 * twin_.levels.size() + iteration_);
  const int draws = temperature == 0 ? 1 : kTopologyDraws;
  std::vector<Choice> choices;
  for (int draw = 0; draw < draws; ++draw) {
    choices.push_back(ChooseClusters(system, DrawScores(distance, temperature, &random), nodes_));
  }
  std::vector<double> errors(draws);
  ParallelFor(draws, options_.threads,
              [&](int draw) { errors[draw] = PredictionError(choices[draw].assignment); });

  Eigen::VectorXd distance_bar = Eigen::VectorXd::Zero(distance.size());
  for (int draw = 0; draw < draws; ++draw) {
    Consider(choices[draw].assignment, errors[draw]);
    if (temperature == 0) continue;
    int worse_than = 0;  // minus how many it is better than
    for (double other : errors) worse_than += (other < errors[draw]) - (other > errors[draw]);
    distance_bar += static_cast<double>(worse_than) / draws *
                    LogProbabilityGradient(system, distance, choices[draw], temperature);
  }
  status_ = fmt::format("level {}, topology: {:.3f} mm (best {:.3f} mm)", twin_.levels.size(),
                        1e3 * *std::min_element(errors.begin(), errors.end()), 1e3 * errors_[0]);
  return distance_bar;
}

Eigen::VectorXd TopologyFit::PositionDistances() const {
  const SpringMassSystem& system = twin_.levels.back().system;
  const std::vector<std::array<int, 2>> pairs = FreePairs(system);
  Eigen::VectorXd distance(static_cast<Eigen::Index>(pairs.size()));
  for (Eigen::Index e = 0; e < distance.size(); ++e) {
    const auto [a, b] = pairs[static_cast<std::size_t>(e)];
    distance[e] = (system.position.col(a) - system.position.col(b)).norm();
  }
  return distance;
}

void TopologyFit::Learn(const Eigen::VectorXd& weights_bar) {
  Adam adam(weights_.size());
  adam.steps = iteration_;
  adam.mean = adam_mean_;
  adam.mean_square = adam_mean_square_;
  adam.Step(weights_bar, Eigen::VectorXd::Constant(weights_.size(), options_.network.learning_rate),
            &weights_);
  adam_mean_ = adam.mean;
  adam_mean_square_ = adam.mean_square;
}

bool TopologyFit::done() const { return iteration_ > kIterations; }

void TopologyFit::Step() {
  using Kind = TrainOptions::Network::Features;
  const double temperature = iteration_ == kIterations ? 0 : Temperature();
  // distances in units of their mean, so that the temperature means the same at all levels
  if (options_.network.features == Kind::kPositions) {
    const Eigen::VectorXd distance = PositionDistances();
    Draw(distance / distance.mean(), temperature);
  } else {
    Tape tape(weights_);
    const Tape::Node latent = network_.Encode(LevelsOf(twin_), &tape).nodes;
    const Tape::Node apart = tape.Distance(latent, FreePairs(twin_.levels.back().system));
    const double unit = tape.value(apart).mean();
    const Eigen::VectorXd distance_bar = Draw(tape.value(apart).col(0) / unit, temperature);
    if (temperature > 0 && options_.network.features == Kind::kLearned) {
      Eigen::VectorXd weights_bar = Eigen::VectorXd::Zero(weights_.size());
      tape.Backward({{apart, distance_bar / unit}}, &weights_bar);
      Learn(weights_bar);
    }
  }
  ++iteration_;
}

double TopologyFit::Progress() const { return static_cast<double>(iteration_) / (kIterations + 1); }

}  // namespace physpring
