// SPDX-License-Identifier: Apache-2.0
#include "trainer/hierarchy_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "trainer/reduction/baselines.h"
#include "trainer/reduction/galerkin.h"
#include "trainer/reduction/gramian.h"
#include "twin/error.h"
#include "twin/hierarchy.h"

namespace physpring {
namespace {

constexpr double kDenseShare = 0.5;     // of the time, that level 0 takes
constexpr double kTopologyShare = 0.3;  // of a coarser level's

// Null for a reduction that is learned.
Reduction ReductionOf(TrainOptions::Reduction method) {
  switch (method) {
    case TrainOptions::Reduction::kLearned:
      return nullptr;
    case TrainOptions::Reduction::kRandom:
      return RandomAssignment;
    case TrainOptions::Reduction::kGramian:
      return GramianAssignment;
    case TrainOptions::Reduction::kKMeans:
      return KMeansAssignment;
  }
  return nullptr;
}

// Away from the ground; where there is none, against gravity.
Eigen::Vector3d Up(const Recording& recording) {
  if (recording.ground) return recording.ground->head<3>().normalized();
  return recording.gravity.norm() > 0 ? Eigen::Vector3d(-recording.gravity.normalized())
                                      : Eigen::Vector3d::UnitZ();
}

// What a fit changes of a system, as arrays train/`name`/...
void StoreParameters(const std::string& name, const SpringMassSystem& system, StateArrays* arrays) {
  const ContactCoefficients& c = system.contact;
  Eigen::VectorXd scalars(6);
  scalars << system.drag, c.restitution, c.friction, c.object_restitution, c.object_friction,
      c.collision_distance;
  const std::string prefix = "train/" + name;
  (*arrays)[prefix + "/scalars"] = StoreVector(scalars);
  (*arrays)[prefix + "/stiffness"] = StoreVector(system.stiffness);
  (*arrays)[prefix + "/rest_length"] = StoreVector(system.rest_length);
  (*arrays)[prefix + "/dashpot"] = StoreVector(system.dashpot);
}

void LoadParameters(const std::string& name, const StateArrays& arrays, SpringMassSystem* system) {
  const Eigen::VectorXd scalars = LoadVector(arrays, name + "/scalars", 6);
  system->drag = scalars[0];
  system->contact = {scalars[1], scalars[2], scalars[3],
                     scalars[4], scalars[5], system->contact.cone};
  const int springs = system->spring_count();
  system->stiffness = LoadVector(arrays, name + "/stiffness", springs);
  system->rest_length = LoadVector(arrays, name + "/rest_length", springs);
  system->dashpot = LoadVector(arrays, name + "/dashpot", springs);
}

// What is being done with the next level.
enum : int { kBetween, kLearnsTopology, kFitsLevel };

std::string LevelName(int level) { return fmt::format("level{}", level); }

}  // namespace

HierarchyFit::HierarchyFit(FitData data, const TrainOptions& options, std::unique_ptr<Fitter> dense)
    : data_(std::move(data)),
      options_(options),
      dense_(std::move(dense)),
      network_(options.network.latent, options.seed),
      weights_(network_.first_weights()) {
  const int particles = data_.recordings.at(0).particle_count();
  int below = particles;
  for (int level = 1; level < options_.levels; ++level) {
    const int nodes = static_cast<int>(std::lround(options_.ratios.at(level - 1) * particles));
    if (nodes < 2 || nodes >= below) {
      throw Error(
          fmt::format("--ratios {}: level {} of {} particles would have {} nodes, expected 2 to {}",
                      options_.ratios[level - 1], level, particles, nodes, below - 1));
    }
    below = nodes;
  }
}

int HierarchyFit::NodesOfNextLevel() const {
  return static_cast<int>(
      std::lround(options_.ratios[done() - 1] * twin_.levels[0].system.node_count()));
}

Twin HierarchyFit::WithNextLevel(const std::vector<int>& assignment) const {
  Twin twin = twin_;
  twin.levels.push_back(
      {Project(twin_.levels.back().system, assignment, Up(data_.recordings[0])).system, assignment,
       0});
  SpreadOrder(&twin);
  return twin;
}

void HierarchyFit::BeginReduction() {
  const Reduction reduce = ReductionOf(options_.reduction);
  if (reduce) {
    BeginLevel(reduce(twin_.levels.back().system, NodesOfNextLevel(),
                      options_.seed * 1000 + static_cast<std::uint64_t>(done())));
  } else {
    topology_.emplace(data_, options_, twin_, network_, weights_, NodesOfNextLevel(),
                      Up(data_.recordings[0]));
  }
}

void HierarchyFit::BeginLevel(const std::vector<int>& assignment) {
  const Twin twin = WithNextLevel(assignment);
  assignment_ = assignment;
  level_.emplace(data_, options_, twin, network_, weights_);
  const SpringMassSystem& system = twin.levels.back().system;
  status_ = fmt::format("level {}: {} nodes, {} springs", done(), system.node_count(),
                        system.spring_count());
}

void HierarchyFit::BeginTrials(const std::vector<std::vector<int>>& candidates) {
  candidates_ = candidates;
  scores_.clear();
  BeginLevel(candidates_[0]);
}

// Fits the common factors of one candidate after the other, and begins the level with the best.
void HierarchyFit::StepTrial() {
  if (!level_->can_be_judged()) {
    level_->Step();
    status_ = fmt::format("candidate {} of {}, {}", scores_.size() + 1, candidates_.size(),
                          level_->Status());
    return;
  }
  scores_.push_back(level_->mean_square());
  if (scores_.size() < candidates_.size()) {
    BeginLevel(candidates_[scores_.size()]);
    return;
  }
  const auto best = std::min_element(scores_.begin(), scores_.end()) - scores_.begin();
  const std::vector<int> chosen = candidates_[static_cast<std::size_t>(best)];
  candidates_.clear();
  if (chosen != assignment_) BeginLevel(chosen);
}

void HierarchyFit::FinishLevel() {
  twin_.levels.push_back({level_->System(), assignment_, level_->SubstepsPerSecond()});
  weights_ = level_->weights();
  level_.reset();
}

bool HierarchyFit::Step() {
  if (done() == 0) {
    if (dense_->Step()) {
      status_ = dense_->Status();
    } else {
      twin_ = dense_->Result();
    }
    return true;
  }
  if (done() == options_.levels) return false;
  if (topology_) {
    if (topology_->Step()) {
      status_ = topology_->Status();
    } else {
      weights_ = topology_->weights();
      BeginTrials(topology_->candidates());
      topology_.reset();
    }
  } else if (!level_) {
    BeginReduction();
  } else if (!candidates_.empty()) {
    StepTrial();
  } else if (level_->Step()) {
    status_ = level_->Status();
  } else {
    FinishLevel();
  }
  return true;
}

std::string HierarchyFit::Part() const {
  if (done() == 0) return dense_->Part();
  return level_ && !topology_ ? level_->Part() : "reduction";
}

double HierarchyFit::Progress() const {
  if (done() == 0) return kDenseShare * dense_->Progress();
  double share = 0;  // of the level
  if (topology_) {
    share = kTopologyShare / 2 * topology_->Progress();
  } else if (!candidates_.empty()) {
    const double tried = static_cast<double>(scores_.size()) / candidates_.size();
    share = kTopologyShare / 2 * (1 + tried);
  } else if (level_) {
    share = kTopologyShare + (1 - kTopologyShare) * level_->Progress();
  }
  const double coarse = done() - 1 + share;
  return kDenseShare + (1 - kDenseShare) * coarse / (options_.levels - 1);
}

StateArrays HierarchyFit::Save() const {
  StateArrays arrays = dense_->Save();
  const int doing = topology_ ? kLearnsTopology : level_ ? kFitsLevel : kBetween;
  arrays["train/levels_done"] = StoreCounters(
      {done(), doing, static_cast<int>(candidates_.size()), static_cast<int>(scores_.size())});
  if (done() > 0 && !topology_) arrays["train/weights"] = StoreVector(weights_);
  for (int level = 1; level < done(); ++level) {
    arrays["train/" + LevelName(level) + "/assignment"] =
        StoreCounters(twin_.levels[level].assignment);
    StoreParameters(LevelName(level), twin_.levels[level].system, &arrays);
    arrays["train/" + LevelName(level) + "/substeps_per_second"] =
        StoreCounters({twin_.levels[level].substeps_per_second});
  }
  if (topology_) arrays.merge(topology_->Save());
  if (!candidates_.empty()) {
    std::vector<int> all;
    for (const auto& one : candidates_) all.insert(all.end(), one.begin(), one.end());
    arrays["train/candidates"] = StoreCounters(all);
    arrays["train/candidate_scores"] = StoreVector(Eigen::Map<const Eigen::VectorXd>(
        scores_.data(), static_cast<Eigen::Index>(scores_.size())));
  }
  if (level_) {
    arrays["train/assignment"] = StoreCounters(assignment_);
    arrays.merge(level_->Save());
  }
  return arrays;
}

void HierarchyFit::Load(const StateArrays& state) {
  dense_->Load(state);
  const std::vector<int> counters = LoadCounters(state, "levels_done", 4);
  twin_ = {};
  topology_.reset();
  level_.reset();
  candidates_.clear();
  scores_.clear();
  if (counters[0] == 0) return;
  twin_ = dense_->Result();
  if (counters[1] != kLearnsTopology) weights_ = LoadVector(state, "weights", weights_.size());
  const auto load_assignment = [&](const std::string& name) {
    const int fine = twin_.levels.back().system.node_count();
    return LoadCounters(state, name, static_cast<std::size_t>(fine));
  };
  for (int level = 1; level < counters[0]; ++level) {
    TwinLevel loaded =
        WithNextLevel(load_assignment(LevelName(level) + "/assignment")).levels.back();
    LoadParameters(LevelName(level), state, &loaded.system);
    loaded.substeps_per_second =
        LoadCounters(state, LevelName(level) + "/substeps_per_second", 1)[0];
    twin_.levels.push_back(std::move(loaded));
  }
  if (counters[1] == kLearnsTopology) {
    BeginReduction();
    topology_->Load(state);
  } else if (counters[1] == kFitsLevel) {
    BeginLevel(load_assignment("assignment"));
    level_->Load(state);
    LoadCandidates(state, counters[2], counters[3]);
  }
}

void HierarchyFit::LoadCandidates(const StateArrays& state, int candidates, int scores) {
  if (candidates == 0) return;
  const int nodes = twin_.levels.back().system.node_count();
  const std::vector<int> all =
      LoadCounters(state, "candidates", static_cast<std::size_t>(candidates) * nodes);
  for (auto one = all.begin(); one != all.end(); one += nodes) {
    candidates_.emplace_back(one, one + nodes);
  }
  const Eigen::VectorXd tried = LoadVector(state, "candidate_scores", scores);
  scores_.assign(tried.begin(), tried.end());
}

Twin HierarchyFit::Result() const {
  if (done() == 0) return dense_->Result();
  Twin twin = twin_;
  if (level_) twin.levels.push_back({level_->System(), assignment_, level_->SubstepsPerSecond()});
  return twin;
}

}  // namespace physpring
