// SPDX-License-Identifier: Apache-2.0
#include "trainer/two_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "trainer/loss.h"
#include "trainer/parallel.h"
#include "trainer/phystwin_variables.h"
#include "twin/error.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr int kGenerations = 20;
constexpr double kStepSize = 1.0 / 6;
constexpr double kFailed = 1e6;      // m^2: objective of a candidate that cannot be simulated
constexpr double kPassRollouts = 5;  // time of a pass, in rollouts of the fit frames

// Sum of the losses of frames 1, 2, ..., or kFailed for each.
double SumOfLosses(const SpringMassSystem& system, const Recording& recording,
                   const RolloutOptions& options) {
  const auto rollout = RollOut(system, {&recording, recording.train_frames}, options);
  if (rollout->diverged()) return kFailed * (recording.train_frames - 1);
  double loss = 0;
  Points unused = Points::Zero(3, system.node_count());
  for (int frame = 1; frame < recording.train_frames; ++frame) {
    loss += AddFrameLoss(rollout->positions()[frame], recording, frame, LossOptions(), &unused);
  }
  return loss;
}

bool JoinsNoController(const SpringMassSystem& system) {
  return system.controllers > 0 &&
         static_cast<int>(system.UnjoinedControllers().size()) == system.controllers;
}

}  // namespace

TwoStageFit::TwoStageFit(FitData data, const TrainOptions& options)
    : data_(std::move(data)),
      options_(options),
      length_scale_(PhysTwinLengthScale(data_.recordings.at(0))),
      passes_(options.epochs > 0 ? options.epochs : PhysTwinPasses(data_.recordings[0])),
      search_(PhysTwinStart(), kStepSize, options.seed) {
  // the widest search; throws where the recording gives no body
  const Eigen::VectorXd widest = Eigen::VectorXd::Ones(kPhysTwinVariables);
  if (!JoinsNoController(SystemAt(widest))) return;
  throw Error(
      fmt::format("recording {}: no controller is near enough to a particle to move it; PhysTwin's "
                  "search joins them up to {:.3g} m apart, --method full at any distance",
                  data_.recordings[0].name, FromUnitCube(widest, length_scale_).controller_radius));
}

SpringMassSystem TwoStageFit::SystemAt(const Eigen::VectorXd& point) const {
  SpringMassSystem system = MakePhysTwinSystem(
      data_.recordings[0], FromUnitCube(point, length_scale_), options_.self_collision);
  if (options_.cone) system.contact.cone = *options_.cone;
  return system;
}

int TwoStageFit::Substeps(const SpringMassSystem& system) const {
  if (options_.substeps > 0) return options_.substeps;
  return StableSubsteps(ComputeStabilityBound(system), 1 / data_.recordings[0].fps, kStepSafety);
}

RolloutOptions TwoStageFit::RolloutOptionsFor(const SpringMassSystem& system) const {
  RolloutOptions options;
  options.single_precision = options_.single_precision;
  options.controller_velocity = options_.controller_velocity.value_or(false);
  options.substeps = Substeps(system);
  return options;
}

// A candidate that joins no controller, would diverge with PhysTwin's sub-step, or diverges with
// ours, has failed.
std::vector<double> TwoStageFit::Objectives(const std::vector<Eigen::VectorXd>& points) const {
  const int recordings = static_cast<int>(data_.recordings.size());
  const int candidates = static_cast<int>(points.size());
  std::vector<SpringMassSystem> systems(candidates);
  std::vector<char> possible(candidates);
  ParallelFor(candidates, options_.threads, [&](int i) {
    systems[i] = SystemAt(points[i]);
    possible[i] =
        !JoinsNoController(systems[i]) &&
        (options_.substeps > 0 || ComputeStabilityBound(systems[i]).timestep >= kPhysTwinSubstep);
  });
  std::vector<double> sums(candidates * recordings, kFailed);
  ParallelFor(candidates * recordings, options_.threads, [&](int k) {
    const int i = k / recordings;
    if (!possible[i]) return;
    sums[k] =
        SumOfLosses(systems[i], data_.recordings[k % recordings], RolloutOptionsFor(systems[i]));
  });
  double frames = 0;
  for (const Recording& recording : data_.recordings) frames += recording.train_frames - 1;
  std::vector<double> objectives;
  for (int i = 0; i < candidates; ++i) {
    double sum = 0;
    for (int j = 0; j < recordings; ++j) sum += sums[i * recordings + j];
    objectives.push_back(possible[i] ? std::min(kFailed, sum / frames) : kFailed);
  }
  return objectives;
}

void TwoStageFit::ExpectSomeSuccess() const {
  if (search_.state().best_objective < kFailed) return;
  throw Error(fmt::format(
      "recording {}: the motion diverges with every start value tried{}", data_.recordings[0].name,
      options_.substeps > 0 ? fmt::format("; {} sub-steps a frame are too few", options_.substeps)
                            : ", even with a stable sub-step; are its positions in metres?"));
}

void TwoStageFit::StepSearch() {
  const std::vector<Eigen::VectorXd> points = search_.Ask();
  const auto first = points.begin() + static_cast<std::ptrdiff_t>(objectives_.size());
  const std::ptrdiff_t count = std::min<std::ptrdiff_t>(options_.threads, points.end() - first);
  for (double objective : Objectives({first, first + count})) objectives_.push_back(objective);

  const int generation = search_.state().generation + 1;
  const double least = *std::min_element(objectives_.begin(), objectives_.end());
  status_ = fmt::format("search, generation {} of {}, candidate {} of {}: loss {:.3e} m^2",
                        generation, kGenerations, objectives_.size(), points.size(),
                        std::min(least, search_.state().best_objective));
  if (objectives_.size() < points.size()) return;
  search_.Tell(objectives_);
  objectives_.clear();
  ExpectSomeSuccess();
  if (generation == kGenerations) BeginFirstOrder();
}

void TwoStageFit::BeginFirstOrder() {
  first_order_.emplace(SystemAt(search_.state().best), passes_);
}

void TwoStageFit::StepFirstOrder() {
  first_order_->Pass(data_.recordings, RolloutOptionsFor(first_order_->Current()),
                     options_.threads);
  status_ = first_order_->diverged()
                ? fmt::format("single springs, pass {} diverged; {}", first_order_->passes() + 1,
                              DescribeBest())
                : fmt::format("single springs, pass {} of {}: loss {:.3e} m^2",
                              first_order_->passes(), passes_, first_order_->last_loss());
  if (first_order_->done() && !first_order_->diverged()) status_ = DescribeBest();
}

std::string TwoStageFit::DescribeBest() const {
  const PhysTwinVariables best = FromUnitCube(search_.state().best, length_scale_);
  return fmt::format(
      "search: Y {:.3g} N, {} neighbours within {:.3g} mm, of controllers {} within {:.3g} mm, "
      "drag {:.3g} 1/s, dashpot {:.3g} 1/s, loss {:.3e} m^2; single springs: loss {:.3e} m^2",
      best.spring_y, best.object_neighbours - 1, 1e3 * best.object_radius,
      best.controller_neighbours, 1e3 * best.controller_radius, best.drag, best.dashpot,
      search_.state().best_objective, first_order_->best_loss());
}

bool TwoStageFit::Step() {
  if (!first_order_) {
    StepSearch();
  } else if (!first_order_->done()) {
    StepFirstOrder();
  } else {
    return false;
  }
  return true;
}

double TwoStageFit::Progress() const {
  if (first_order_ && first_order_->done()) return 1;
  const double searched =
      search_.state().generation * search_.population() + static_cast<double>(objectives_.size());
  const double passed = first_order_ ? first_order_->passes() : 0;
  const double all = kGenerations * search_.population() + kPassRollouts * passes_;
  return (searched + kPassRollouts * passed) / all;
}

std::map<std::string, NpzArray> TwoStageFit::Save() const {
  StateArrays state = {
      {"train/objectives", NpzArray::Doubles({objectives_.size()}, objectives_.data())},
      {"train/objective_count", StoreCounters({static_cast<int>(objectives_.size())})},
  };
  search_.Save(&state);
  if (first_order_) first_order_->Save(&state);
  return state;
}

void TwoStageFit::Load(const std::map<std::string, NpzArray>& state) {
  search_.Load(state);
  const int count = LoadCounters(state, "objective_count", 1)[0];
  const Eigen::VectorXd objectives = LoadVector(state, "objectives", count);
  objectives_.assign(objectives.begin(), objectives.end());
  first_order_.reset();
  if (search_.state().generation < kGenerations) return;
  BeginFirstOrder();
  first_order_->Load(state);
  if (first_order_->done()) status_ = DescribeBest();
}

Twin TwoStageFit::Result() const {
  const Recording& recording = data_.recordings[0];
  Twin twin;
  TwinLevel& level = twin.levels.emplace_back();
  level.system = first_order_ ? first_order_->Best() : SystemAt(search_.state().best);
  level.substeps_per_second =
      static_cast<int>(std::ceil(Substeps(level.system) * recording.fps - 1e-9));
  twin.points = recording.point_count();
  twin.interior = recording.interior_count();
  twin.order = recording.order;
  twin.controller_velocity = options_.controller_velocity.value_or(false);
  twin.fps = recording.fps;
  twin.gravity = recording.gravity;
  twin.seed = options_.seed;
  return twin;
}

}  // namespace physpring
