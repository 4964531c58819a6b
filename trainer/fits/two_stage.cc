// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/two_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "trainer/bodies/phystwin_variables.h"
#include "trainer/fits/first_order_stage.h"
#include "trainer/motion/loss.h"
#include "trainer/motion/rollout.h"
#include "trainer/solvers/cma_es.h"
#include "twin/error.h"
#include "twin/parallel.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr int kGenerations = 20;
constexpr double kStepSize = 1.0 / 6;
constexpr double kFailed = 1e6;      // m^2: objective of a candidate that cannot be simulated
constexpr double kPassRollouts = 5;  // a pass takes as long as so many rollouts of the fit frames

// Sum of the losses of frames 1, 2, ...; kFailed for each of them where the motion diverges.
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

// The search in the unit cube, in the middle of a generation.
struct Search {
  CmaEs cma_es;
  std::vector<double> objectives;  // those of this generation's candidates, as far as known

  template <class Visitor>
  void Visit(Visitor&& visit) {
    visit(cma_es, objectives);
  }
};

// What is fitted, and how.
class TwoStage {
 public:
  TwoStage(const FitData& data, const TrainOptions& options);

  // Tries as many candidates of a generation as there are threads.
  StepReport StepSearch(Search* search) const;
  // Makes one pass of the second stage, after a search that ended with `searched`.
  StepReport StepFirstOrder(const CmaEsState& searched, FirstOrderStage* stage) const;

  SpringMassSystem SystemAt(const Eigen::VectorXd& point) const;  // at a point of the unit cube
  Twin TwinOf(const SpringMassSystem& system) const;
  int passes() const { return passes_; }

 private:
  void ExpectSomeSuccess(const CmaEsState& search) const;
  std::vector<double> Objectives(const std::vector<Eigen::VectorXd>& points) const;
  int Substeps(const SpringMassSystem& system) const;  // how many a frame takes
  RolloutOptions RolloutOptionsFor(const SpringMassSystem& system) const;
  std::string DescribeBest(const CmaEsState& searched, const FirstOrderStage& stage) const;

  const FitData& data_;
  const TrainOptions& options_;
  double length_scale_;
  int passes_;  // how many the second stage makes
};

TwoStage::TwoStage(const FitData& data, const TrainOptions& options)
    : data_(data),
      options_(options),
      length_scale_(PhysTwinLengthScale(data_.recordings.at(0))),
      passes_(options.epochs > 0 ? options.epochs : PhysTwinPasses(data_.recordings[0])) {
  // the widest search for springs; SystemAt throws where the recording gives no body
  const Eigen::VectorXd widest = Eigen::VectorXd::Ones(kPhysTwinVariables);
  if (!JoinsNoController(SystemAt(widest))) return;
  throw Error(
      fmt::format("recording {}: no controller is near enough to a particle to move it; PhysTwin's "
                  "search joins them up to {:.3g} m apart, --method full at any distance",
                  data_.recordings[0].name, FromUnitCube(widest, length_scale_).controller_radius));
}

SpringMassSystem TwoStage::SystemAt(const Eigen::VectorXd& point) const {
  SpringMassSystem system = MakePhysTwinSystem(
      data_.recordings[0], FromUnitCube(point, length_scale_), options_.self_collision);
  if (options_.cone) system.contact.surface.cone = *options_.cone;
  return system;
}

int TwoStage::Substeps(const SpringMassSystem& system) const {
  if (options_.substeps > 0) return options_.substeps;
  return StableSubsteps(ComputeStabilityBound(system), 1 / data_.recordings[0].fps, kStepSafety);
}

RolloutOptions TwoStage::RolloutOptionsFor(const SpringMassSystem& system) const {
  RolloutOptions options;
  options.single_precision = options_.single_precision;
  options.controller_velocity = options_.controller_velocity.value_or(false);
  options.substeps = Substeps(system);
  return options;
}

// A candidate that joins no controller, would diverge with PhysTwin's sub-step, or diverges with
// ours, has failed.
std::vector<double> TwoStage::Objectives(const std::vector<Eigen::VectorXd>& points) const {
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

void TwoStage::ExpectSomeSuccess(const CmaEsState& search) const {
  if (search.best_objective < kFailed) return;
  throw Error(fmt::format(
      "recording {}: the motion diverges with every start value tried{}", data_.recordings[0].name,
      options_.substeps > 0 ? fmt::format("; {} sub-steps a frame are too few", options_.substeps)
                            : ", even with a stable sub-step; are its positions in metres?"));
}

StepReport TwoStage::StepSearch(Search* search) const {
  std::vector<double>& objectives = search->objectives;
  const std::vector<Eigen::VectorXd> points = search->cma_es.Ask();
  const auto first = points.begin() + static_cast<std::ptrdiff_t>(objectives.size());
  const std::ptrdiff_t count = std::min<std::ptrdiff_t>(options_.threads, points.end() - first);
  for (double objective : Objectives({first, first + count})) objectives.push_back(objective);

  const int generation = search->cma_es.state().generation + 1;
  const double least = *std::min_element(objectives.begin(), objectives.end());
  const double of_generation =
      static_cast<double>(objectives.size()) / static_cast<double>(points.size());
  StepReport report{false, (generation - 1 + of_generation) / kGenerations,
                    fmt::format("search, generation {} of {}, candidate {} of {}: loss {:.3e} m^2",
                                generation, kGenerations, objectives.size(), points.size(),
                                std::min(least, search->cma_es.state().best_objective))};
  if (objectives.size() < points.size()) return report;
  search->cma_es.Tell(objectives);
  objectives.clear();
  ExpectSomeSuccess(search->cma_es.state());
  report.done = generation == kGenerations;
  return report;
}

StepReport TwoStage::StepFirstOrder(const CmaEsState& searched, FirstOrderStage* stage) const {
  stage->Pass(data_.recordings, RolloutOptionsFor(stage->Current()), options_.threads);
  StepReport report{stage->done(), static_cast<double>(stage->passes()) / passes_,
                    fmt::format("single springs, pass {} of {}: loss {:.3e} m^2", stage->passes(),
                                passes_, stage->last_loss())};
  if (stage->diverged()) {
    report.status = fmt::format("single springs, pass {} diverged; {}", stage->passes() + 1,
                                DescribeBest(searched, *stage));
  } else if (stage->done()) {
    report.status = DescribeBest(searched, *stage);
  }
  return report;
}

std::string TwoStage::DescribeBest(const CmaEsState& searched, const FirstOrderStage& stage) const {
  const PhysTwinVariables best = FromUnitCube(searched.best, length_scale_);
  return fmt::format(
      "search: Y {:.3g} N, {} neighbours within {:.3g} mm, of controllers {} within {:.3g} mm, "
      "drag {:.3g} 1/s, dashpot {:.3g} 1/s, loss {:.3e} m^2; single springs: loss {:.3e} m^2",
      best.spring_y, best.object_neighbours - 1, 1e3 * best.object_radius,
      best.controller_neighbours, 1e3 * best.controller_radius, best.drag, best.dashpot,
      searched.best_objective, stage.best_loss());
}

Twin TwoStage::TwinOf(const SpringMassSystem& system) const {
  const Recording& recording = data_.recordings[0];
  Twin twin =
      DenseTwin(recording, system, options_.controller_velocity.value_or(false), options_.seed);
  twin.levels[0].substeps_per_second =
      static_cast<int>(std::ceil(Substeps(system) * recording.fps - 1e-9));
  return twin;
}

}  // namespace

Twin FitTwoStage(const FitData& data, const TrainOptions& options, const Work& work) {
  const TwoStage fit(data, options);
  const CmaEs start(PhysTwinStart(), kStepSize, options.seed);
  work.Reached(fit.TwinOf(fit.SystemAt(start.state().best)));

  const double searching = kGenerations * start.population();
  const double searched_part = searching / (searching + kPassRollouts * fit.passes());
  const CmaEsState searched =
      work.Part("search", 0, searched_part)
          .Follow(Search{start, {}}, [&](Search* one) { return fit.StepSearch(one); })
          .cma_es.state();
  const SpringMassSystem best = fit.SystemAt(searched.best);
  work.Reached(fit.TwinOf(best));

  const FirstOrderStage springs =
      work.Part("single springs", searched_part, 1)
          .Follow(FirstOrderStage(best, fit.passes()),
                  [&](FirstOrderStage* one) { return fit.StepFirstOrder(searched, one); });
  return fit.TwinOf(springs.Best());
}

}  // namespace physpring
