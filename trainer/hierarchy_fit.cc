// SPDX-License-Identifier: Apache-2.0
#include "trainer/hierarchy_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "trainer/parallel.h"
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

// The arrays whose names begin with `from`, which becomes `to`.
StateArrays Renamed(const StateArrays& arrays, const std::string& from, const std::string& to) {
  StateArrays renamed;
  for (auto entry = arrays.lower_bound(from);
       entry != arrays.end() && entry->first.starts_with(from); ++entry) {
    renamed[to + entry->first.substr(from.size())] = entry->second;
  }
  return renamed;
}

constexpr const char* kLevelPrefix = "train/level/";  // of what a LevelFit saves
std::string TrialPrefix(std::size_t trial) { return fmt::format("train/trial{}/", trial); }

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
    BeginTrials({reduce(twin_.levels.back().system, NodesOfNextLevel(),
                        options_.seed * 1000 + static_cast<std::uint64_t>(done()))});
  } else {
    topology_.emplace(data_, options_, twin_, network_, weights_, NodesOfNextLevel(),
                      Up(data_.recordings[0]));
  }
}

void HierarchyFit::BeginTrials(const std::vector<std::vector<int>>& candidates) {
  trials_.clear();
  for (const std::vector<int>& assignment : candidates) {
    trials_.push_back(std::make_unique<Trial>(
        assignment, LevelFit(data_, options_, WithNextLevel(assignment), network_, weights_)));
  }
  const SpringMassSystem system = trials_[0]->level.System();
  status_ = fmt::format("level {}: {} nodes, {} springs", done(), system.node_count(),
                        system.spring_count());
}

// Fits the common factors of the first candidates that have not got theirs, each with its share of
// the threads; when all have, leaves the best.
void HierarchyFit::StepTrials() {
  std::vector<int> running;
  for (std::size_t i = 0; i < trials_.size(); ++i) {
    if (!trials_[i]->level.can_be_judged()) running.push_back(static_cast<int>(i));
  }
  if (running.empty()) {
    const auto best =
        std::min_element(trials_.begin(), trials_.end(), [](const auto& a, const auto& b) {
          return a->level.mean_square() < b->level.mean_square();
        });
    std::iter_swap(trials_.begin(), best);
    trials_.resize(1);
    return;
  }
  ParallelFirst(running, options_.threads,
                [this](int i, int threads) { trials_[i]->level.Step(threads); });
  status_ = fmt::format("candidate {} of {}, {}", running[0] + 1, trials_.size(),
                        trials_[running[0]]->level.Status());
}

void HierarchyFit::FinishLevel() {
  const Trial& chosen = *trials_[0];
  twin_.levels.push_back(
      {chosen.level.System(), chosen.assignment, chosen.level.SubstepsPerSecond()});
  weights_ = chosen.level.weights();
  trials_.clear();
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
  } else if (trials_.empty()) {
    BeginReduction();
  } else if (trials_.size() > 1) {
    StepTrials();
  } else if (trials_[0]->level.Step(options_.threads)) {
    status_ = trials_[0]->level.Status();
  } else {
    FinishLevel();
  }
  return true;
}

std::string HierarchyFit::Part() const {
  if (done() == 0) return dense_->Part();
  return trials_.empty() ? "reduction" : trials_[0]->level.Part();
}

double HierarchyFit::Progress() const {
  if (done() == 0) return kDenseShare * dense_->Progress();
  double share = 0;  // of the level
  if (topology_) {
    share = kTopologyShare / 2 * topology_->Progress();
  } else if (trials_.size() > 1) {
    double tried = 0;
    for (const auto& trial : trials_) tried += trial->level.ProgressOfTrial() / trials_.size();
    share = kTopologyShare / 2 * (1 + tried);
  } else if (!trials_.empty()) {
    share = kTopologyShare + (1 - kTopologyShare) * trials_[0]->level.Progress();
  }
  const double coarse = done() - 1 + share;
  return kDenseShare + (1 - kDenseShare) * coarse / (options_.levels - 1);
}

StateArrays HierarchyFit::Save() const {
  StateArrays arrays = dense_->Save();
  const int doing = topology_ ? kLearnsTopology : trials_.empty() ? kBetween : kFitsLevel;
  arrays["train/levels_done"] = StoreCounters({done(), doing, static_cast<int>(trials_.size())});
  if (done() > 0 && !topology_) arrays["train/weights"] = StoreVector(weights_);
  for (int level = 1; level < done(); ++level) {
    arrays["train/" + LevelName(level) + "/assignment"] =
        StoreCounters(twin_.levels[level].assignment);
    StoreParameters(LevelName(level), twin_.levels[level].system, &arrays);
    arrays["train/" + LevelName(level) + "/substeps_per_second"] =
        StoreCounters({twin_.levels[level].substeps_per_second});
  }
  if (topology_) arrays.merge(topology_->Save());
  SaveTrials(&arrays);
  return arrays;
}

void HierarchyFit::SaveTrials(StateArrays* arrays) const {
  for (std::size_t i = 0; i < trials_.size(); ++i) {
    (*arrays)[TrialPrefix(i) + "assignment"] = StoreCounters(trials_[i]->assignment);
    arrays->merge(Renamed(trials_[i]->level.Save(), kLevelPrefix, TrialPrefix(i)));
  }
}

std::vector<int> HierarchyFit::LoadAssignment(const StateArrays& state,
                                              const std::string& name) const {
  return LoadCounters(state, name + "/assignment",
                      static_cast<std::size_t>(twin_.levels.back().system.node_count()));
}

void HierarchyFit::Load(const StateArrays& state) {
  dense_->Load(state);
  const std::vector<int> counters = LoadCounters(state, "levels_done", 3);
  twin_ = {};
  topology_.reset();
  trials_.clear();
  if (counters[0] == 0) return;
  twin_ = dense_->Result();
  if (counters[1] != kLearnsTopology) weights_ = LoadVector(state, "weights", weights_.size());
  for (int level = 1; level < counters[0]; ++level) {
    TwinLevel loaded = WithNextLevel(LoadAssignment(state, LevelName(level))).levels.back();
    LoadParameters(LevelName(level), state, &loaded.system);
    loaded.substeps_per_second =
        LoadCounters(state, LevelName(level) + "/substeps_per_second", 1)[0];
    twin_.levels.push_back(std::move(loaded));
  }
  if (counters[1] == kLearnsTopology) {
    BeginReduction();
    topology_->Load(state);
  } else if (counters[1] == kFitsLevel) {
    LoadTrials(state, counters[2]);
  }
}

void HierarchyFit::LoadTrials(const StateArrays& state, int count) {
  std::vector<std::vector<int>> candidates;
  for (int i = 0; i < count; ++i) {
    candidates.push_back(LoadAssignment(state, fmt::format("trial{}", i)));
  }
  BeginTrials(candidates);
  for (std::size_t i = 0; i < trials_.size(); ++i) {
    trials_[i]->level.Load(Renamed(state, TrialPrefix(i), kLevelPrefix));
  }
}

Twin HierarchyFit::Result() const {
  if (done() == 0) return dense_->Result();
  Twin twin = twin_;
  if (!trials_.empty()) {
    const Trial& first = *trials_[0];
    twin.levels.push_back(
        {first.level.System(), first.assignment, first.level.SubstepsPerSecond()});
  }
  return twin;
}

}  // namespace physpring
