// SPDX-License-Identifier: Apache-2.0
#include "trainer/reduction/topology_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "trainer/adam.h"
#include "trainer/held_back.h"
#include "trainer/lifted_motion.h"
#include "trainer/network/level_network.h"
#include "twin/error.h"

namespace physpring {
namespace {

constexpr int kIterations = 40;
constexpr int kDraws = 4;  // an iteration
constexpr double kHottest = 1, kColdest = 0.1;
constexpr std::size_t kCandidates = 3;
constexpr int kMostRecordings = 4;
constexpr int kMostFrames = 16;  // of a recording

// The motion of level 0, which is seen everywhere and free of noise.
std::vector<ParticleMotion> DenseMotion(const FitData& data, const TrainOptions& options,
                                        const Twin& twin) {
  LiftedMotion::Options motion_options;
  motion_options.rollout.single_precision = options.single_precision;
  motion_options.rollout.controller_velocity = twin.controller_velocity;
  motion_options.rollout.substeps = options.substeps;
  motion_options.threads = options.threads;
  motion_options.most_substeps = std::numeric_limits<int>::max();
  const LiftedMotion dense(twin, 0, FitEpisodes(data, kMostRecordings), motion_options);
  const SpringMassSystem& system = twin.levels[0].system;
  const auto moved = dense.Run(system, dense.Substeps(system));
  if (!moved)
    throw Error(fmt::format("twin {}: level 0 diverges on its own recordings", twin.name));
  std::vector<ParticleMotion> motions;
  for (int e = 0; e < dense.episode_count(); ++e) {
    ParticleMotion& motion = motions.emplace_back();
    motion.start = moved->particles[e][0];
    const int frames = dense.frames(e), kept = std::min(kMostFrames, frames - 1);
    for (int k = 1; k <= kept; ++k) {
      motion.frames.push_back(moved->particles[e][k * (frames - 1) / kept]);
    }
  }
  return motions;
}

}  // namespace

TopologyFit::TopologyFit(const FitData& data, const TrainOptions& options, const Twin& twin,
                         const GraphNetwork& network, const Eigen::VectorXd& weights, int nodes,
                         const Eigen::Vector3d& up)
    : options_(options),
      twin_(twin),
      network_(network),
      nodes_(nodes),
      loss_(twin, DenseMotion(data, options, twin), up),
      weights_(weights),
      adam_mean_(Eigen::VectorXd::Zero(weights.size())),
      adam_mean_square_(adam_mean_) {}

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

bool TopologyFit::Step() {
  if (iteration_ > kIterations) return false;
  Tape tape(weights_);
  const SpringMassSystem& system = twin_.levels.back().system;
  const Tape::Node latent = network_.Encode(LevelsOf(twin_), &tape).nodes;
  const Tape::Node apart = tape.Distance(latent, FreePairs(system));
  // in units of the mean distance, so that the temperature means the same at all levels
  const double unit = tape.value(apart).mean();
  const Eigen::VectorXd distance = tape.value(apart).col(0) / unit;

  const bool last = iteration_ == kIterations;
  const double temperature = last ? 0 : Temperature();
  std::mt19937_64 random(options_.seed * 1000003 + 1009 * twin_.levels.size() + iteration_);
  Eigen::VectorXd distance_bar = Eigen::VectorXd::Zero(distance.size());
  double mean_error = 0;
  const int draws = last ? 1 : kDraws;
  for (int draw = 0; draw < draws; ++draw) {
    const Eigen::MatrixX2d scores = DrawScores(distance, temperature, &random);
    const Choice choice = ChooseClusters(system, scores, nodes_);
    const double error = loss_.Error(choice.assignment);
    mean_error += error / draws;
    Consider(choice.assignment, error);
    if (!last) distance_bar += loss_.DistanceGradient(choice, scores, temperature) / draws;
  }
  status_ = fmt::format("level {}, topology: {:.3f} mm (best {:.3f} mm)", twin_.levels.size(),
                        1e3 * mean_error, 1e3 * errors_[0]);
  if (!last) {
    Eigen::VectorXd weights_bar = Eigen::VectorXd::Zero(weights_.size());
    tape.Backward({{apart, distance_bar / unit}}, &weights_bar);
    Adam adam(weights_.size());
    adam.steps = iteration_;
    adam.mean = adam_mean_;
    adam.mean_square = adam_mean_square_;
    adam.Step(weights_bar,
              Eigen::VectorXd::Constant(weights_.size(), options_.network.learning_rate),
              &weights_);
    adam_mean_ = adam.mean;
    adam_mean_square_ = adam.mean_square;
  }
  ++iteration_;
  return true;
}

double TopologyFit::Progress() const { return static_cast<double>(iteration_) / (kIterations + 1); }

StateArrays TopologyFit::Save() const {
  std::vector<int> candidates;
  for (const Assignment& one : candidates_) {
    candidates.insert(candidates.end(), one.begin(), one.end());
  }
  const Eigen::Map<const Eigen::VectorXd> errors(errors_.data(),
                                                 static_cast<Eigen::Index>(errors_.size()));
  return {{"train/topology/counters",
           StoreCounters({iteration_, static_cast<int>(candidates_.size())})},
          {"train/topology/candidates", StoreCounters(candidates)},
          {"train/topology/errors", StoreVector(errors)},
          {"train/topology/weights", StoreVector(weights_)},
          {"train/topology/adam_mean", StoreVector(adam_mean_)},
          {"train/topology/adam_mean_square", StoreVector(adam_mean_square_)}};
}

void TopologyFit::Load(const StateArrays& state) {
  const std::vector<int> counters = LoadCounters(state, "topology/counters", 2);
  iteration_ = counters[0];
  const auto count = static_cast<std::size_t>(counters[1]);
  const auto nodes = static_cast<std::size_t>(twin_.levels.back().system.node_count());
  const std::vector<int> all = LoadCounters(state, "topology/candidates", count * nodes);
  candidates_.clear();
  for (auto one = all.begin(); one != all.end(); one += static_cast<std::ptrdiff_t>(nodes)) {
    candidates_.emplace_back(one, one + static_cast<std::ptrdiff_t>(nodes));
  }
  const Eigen::VectorXd errors =
      LoadVector(state, "topology/errors", static_cast<Eigen::Index>(count));
  errors_.assign(errors.begin(), errors.end());
  weights_ = LoadVector(state, "topology/weights", weights_.size());
  adam_mean_ = LoadVector(state, "topology/adam_mean", weights_.size());
  adam_mean_square_ = LoadVector(state, "topology/adam_mean_square", weights_.size());
}

}  // namespace physpring
