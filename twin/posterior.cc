// SPDX-License-Identifier: Apache-2.0
#include "twin/posterior.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <utility>

#include "twin/effects/registry.h"
#include "twin/error.h"
#include "twin/hierarchy.h"
#include "twin/quote.h"
#include "twin/stability.h"
#include "twin/twin.h"
#include "twin/uniform.h"

namespace physpring {
namespace {

constexpr double kMostSlower = 2;  // than the fitted level, in sub-steps

// What one draw does to level 0.
struct Move {
  Eigen::VectorXd stiffness, loss_time;  // (springs), logarithms
  double drag;
  Eigen::VectorXd contact, effects;
};

Move MoveAlong(const Posterior& posterior, const Eigen::VectorXd& numbers) {
  return {posterior.stiffness.transpose() * numbers, posterior.loss_time.transpose() * numbers,
          posterior.drag.dot(numbers), posterior.contact.transpose() * numbers,
          posterior.effects.transpose() * numbers};
}

void MoveEffects(const Eigen::VectorXd& by, std::vector<EffectValues>* effects) {
  Eigen::Index i = 0;
  for (EffectValues& effect : *effects) {
    double* value = effect.values.data();
    for (const EffectParameter& parameter : GetEffect(effect.name).parameters()) {
      const bool logarithmic = parameter.spacing == EffectParameter::Spacing::kLogarithmic;
      for (int n = 0; n < parameter.count; ++n, ++value, ++i) {
        const double moved = logarithmic ? *value * std::exp(by[i]) : *value + by[i];
        *value =
            std::clamp(moved, std::min(*value, parameter.low), std::max(*value, parameter.high));
      }
    }
  }
}

void Apply(const Move& move, SpringMassSystem* system) {
  const Eigen::ArrayXd factor = move.stiffness.array().exp();
  system->stiffness.array() *= factor;
  system->dashpot.array() *= factor * move.loss_time.array().exp();
  system->drag *= std::exp(move.drag);
  for (int i = 0; i < kContactCount; ++i) {
    const auto& coefficient = kContactCoefficients<double>[i];
    double& value = system->contact.surface.*coefficient.member;
    value = std::min(coefficient.most, value * std::exp(move.contact[i]));
  }
  MoveEffects(move.effects, &system->effects);
}

// Sums of logarithms with weights.
struct WeightedMean {
  double stiffness = 0, loss_time = 0, weight = 0;

  void Add(double of_stiffness, double of_loss_time, double with) {
    stiffness += with * of_stiffness;
    loss_time += with * of_loss_time;
    weight += with;
  }
  void Add(const WeightedMean& other) {
    stiffness += other.stiffness;
    loss_time += other.loss_time;
    weight += other.weight;
  }
};

// What a move of level 0 is to the springs of a coarser level. A spring that stands for none of
// level 0 follows those at its ends.
Move MoveOfLevel(const Move& move, const Twin& twin, int level) {
  const SpringMassSystem& dense = twin.levels[0].system;
  const SpringMassSystem& coarse = twin.levels[static_cast<std::size_t>(level)].system;
  std::vector<int> column = NodesOfParticles(twin, level);
  for (int c = 0; c < dense.controllers; ++c) column.push_back(coarse.node_count() + c);

  std::map<std::pair<int, int>, WeightedMean> of_pair;
  std::vector<WeightedMean> of_node(static_cast<std::size_t>(coarse.position.cols()));
  for (int e = 0; e < dense.spring_count(); ++e) {
    const auto [a, b] = std::minmax(column[dense.springs[e][0]], column[dense.springs[e][1]]);
    for (WeightedMean* mean : {&of_pair[{a, b}], &of_node[a], &of_node[b]}) {
      mean->Add(move.stiffness[e], move.loss_time[e], dense.stiffness[e]);
    }
  }
  Move moved = move;
  moved.stiffness.resize(coarse.spring_count());
  moved.loss_time.resize(coarse.spring_count());
  for (int e = 0; e < coarse.spring_count(); ++e) {
    const auto [a, b] = std::minmax(coarse.springs[e][0], coarse.springs[e][1]);
    WeightedMean mean;
    if (const auto found = of_pair.find({a, b}); found != of_pair.end()) mean = found->second;
    if (mean.weight <= 0) {
      mean = of_node[a];
      mean.Add(of_node[b]);
    }
    moved.stiffness[e] = mean.weight > 0 ? mean.stiffness / mean.weight : 0;
    moved.loss_time[e] = mean.weight > 0 ? mean.loss_time / mean.weight : 0;
  }
  return moved;
}

}  // namespace

SpringMassSystem MovedAlong(const Posterior& posterior, const SpringMassSystem& system,
                            const Eigen::VectorXd& numbers) {
  SpringMassSystem moved = system;
  Apply(MoveAlong(posterior, numbers), &moved);
  return moved;
}

Twin SampleOf(const Twin& twin, std::uint64_t seed, int index) {
  if (twin.posterior.empty()) {
    throw Error(
        fmt::format("twin {}: holds no posterior to draw samples from (train gives one to nets of "
                    "springs, not to "
                    "chains, nor with --method two-stage)",
                    Quote(twin.name)));
  }
  std::seed_seq seeds = {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                         static_cast<std::uint32_t>(index)};
  std::mt19937_64 random(seeds);
  Eigen::VectorXd numbers(twin.posterior.size());
  for (double& number : numbers) number = Normal(&random);
  const Move move = MoveAlong(twin.posterior, numbers);

  Twin sample = twin;
  sample.posterior = {};
  sample.material.reset();
  sample.fit_errors.reset();
  sample.training_state.clear();
  for (int level = 0; level < static_cast<int>(twin.levels.size()); ++level) {
    TwinLevel& one = sample.levels[static_cast<std::size_t>(level)];
    Apply(level == 0 ? move : MoveOfLevel(move, twin, level), &one.system);
    one.system.Validate(
        fmt::format("twin {}: sample {}: level {}", Quote(twin.name), index, level));
    SoftenStiffNodes(1 / (kMostSlower * one.substeps_per_second * kStepSafety), &one.system);
    const int needed = StableSubsteps(ComputeStabilityBound(one.system), 1, kStepSafety);
    const int before = StableSubsteps(
        ComputeStabilityBound(twin.levels[static_cast<std::size_t>(level)].system), 1, kStepSafety);
    if (needed > before) one.substeps_per_second = std::max(one.substeps_per_second, needed);
  }
  return sample;
}

}  // namespace physpring
