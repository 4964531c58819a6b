// SPDX-License-Identifier: Apache-2.0
#include "trainer/level_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "trainer/fit_model.h"
#include "trainer/levenberg_marquardt.h"
#include "trainer/lifted_loss.h"
#include "trainer/motion_problem.h"
#include "trainer/network/level_network.h"
#include "trainer/observer.h"
#include "twin/error.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr int kMostLevelRecordings = 4;  // that common factors are fitted to
constexpr int kFirstGain = 1;            // of kObserverGains: a Galerkin projection is not far off
constexpr int kLevelStepsPerGain = 4;
constexpr int kLevelGaussNewtonSteps = 6;
constexpr int kLevelConjugateGradients = 12;

// Of a frame: never more than level 0 needs.
int MostSubsteps(const TwinLevel& dense, double fps) {
  return std::max(StableSubsteps(ComputeStabilityBound(dense.system), 1 / fps, kStepSafety),
                  static_cast<int>(std::ceil(dense.substeps_per_second / fps)));
}

}  // namespace

LevelFit::LevelFit(const FitData& data, const TrainOptions& options, const Twin& twin,
                   const GraphNetwork& network, const Eigen::VectorXd& weights)
    : data_(data),
      options_(options),
      twin_(twin),
      level_(static_cast<int>(twin.levels.size()) - 1),
      most_substeps_(MostSubsteps(twin.levels[0], data.recordings[0].fps)),
      held_back_(HoldBack(data, kMostLevelRecordings)),
      network_(network),
      gain_(kFirstGain),
      common_(Eigen::VectorXd::Zero(CommonParameters().size())),
      corrections_(BeginCorrections(weights)) {
  if (options_.substeps > 0) return;
  // a projection sums the springs between clusters, and a light cluster may get many
  SpringMassSystem& system = twin_.levels.back().system;
  const double timestep = 1 / (data.recordings[0].fps * most_substeps_ * kStepSafety);
  if (ComputeStabilityBound(system).timestep < timestep) SoftenStiffNodes(timestep, &system);
}

CorrectionsFit LevelFit::BeginCorrections(const Eigen::VectorXd& weights) const {
  return {options_.network, data_.recordings[0].ground.has_value(), weights};
}

LiftedMotion::Options LevelFit::MotionOptions(int threads, double gain) const {
  LiftedMotion::Options motion;
  motion.rollout.single_precision = options_.single_precision;
  motion.rollout.controller_velocity = twin_.controller_velocity;
  motion.rollout.substeps = options_.substeps;
  motion.rollout.observer_gain = gain;
  motion.most_substeps = most_substeps_;
  motion.threads = threads;
  return motion;
}

Parameters LevelFit::CommonParameters() const {
  return CommonFactors(twin_.levels[level_].system, data_.recordings[0]);
}

Parameters LevelFit::SpringParameters() const {
  return SpringFactors(CorrectedSystem(), data_.recordings[0]);
}

// What the network corrects: the common factors, and the contact's coefficients as they are
// updated. The network adds to the same logits.
SpringMassSystem LevelFit::NetworkBase(const Eigen::VectorXd& contact) const {
  SpringMassSystem base = CommonParameters().Apply(common_);
  if (contact.isZero(0)) return base;
  Features of_system(1, 3);
  of_system << 0, contact[0], contact[1];
  return ApplyCorrections(base, Features::Zero(base.spring_count(), 2), of_system);
}

// With the best corrections so far.
SpringMassSystem LevelFit::CorrectedSystem() const {
  SpringMassSystem base = NetworkBase(corrections_.best_contact());
  if (options_.network.epochs == 0) return base;
  return LevelNetwork(network_, twin_, base, corrections_.best_weights()).corrected();
}

void LevelFit::StepCommon() {
  const Parameters parameters = CommonParameters();
  // the differences run in parallel
  MotionProblem problem(parameters,
                        LiftedMotion(twin_, level_, FitEpisodes(data_, kMostLevelRecordings),
                                     MotionOptions(1, kObserverGains[gain_])),
                        0);
  LevenbergMarquardtOptions options;
  options.threads = options_.threads;
  options.difference = FactorDifference(data_.recordings[0]);
  LevenbergMarquardtState state{common_, damping_, mean_square_, false};
  state = LevenbergMarquardtStep([&](const Eigen::VectorXd& x) { return problem.Residuals(x); },
                                 state, options);
  common_ = state.x;
  damping_ = state.damping;
  mean_square_ = state.mean_square > 0 ? state.mean_square
                                       : std::numeric_limits<double>::infinity();  // it diverges
  status_ =
      fmt::format("level {}, common factors: {:.3f} mm", level_, PointMillimetres(mean_square_));
  if (++iteration_ < kLevelStepsPerGain && !state.converged) return;
  iteration_ = 0;
  damping_ = 1e-2;
  if (++gain_ <= kLastGain) return;
  if (options_.network.epochs == 0) {
    BeginSprings();
    return;
  }
  stage_ = Stage::kNetwork;
  corrections_ = BeginCorrections(network_.WithoutCorrections(corrections_.best_weights()));
}

void LevelFit::BeginSprings() {
  stage_ = Stage::kSprings;
  iteration_ = 0;
  damping_ = 1e-3;
  springs_ = Eigen::VectorXd::Zero(SpringParameters().size());
}

// The mean track error of the held-back frames, m, under the observer's last gain above 0: free
// motions that slip at one moment or another would decide by chance. Infinite where it diverges.
double LevelFit::HeldBackError(const SpringMassSystem& system) const {
  std::vector<Episode> episodes;
  for (const HeldBack::Judged& judged : held_back_.judged) {
    episodes.push_back({judged.whole, judged.whole->train_frames});
  }
  const LiftedMotion motion(twin_, level_, episodes,
                            MotionOptions(options_.threads, kObserverGains[kLastGain - 1]));
  const auto moved = motion.Run(system, motion.SubstepsOf(system));
  if (!moved) return std::numeric_limits<double>::infinity();
  double sum = 0;
  for (std::size_t e = 0; e < episodes.size(); ++e) {
    const Recording& held_back = held_back_.judged[e].held_back;
    sum +=
        MeanTrackError((*moved)[e].particles(), held_back, 1, held_back.train_frames).value_or(0);
  }
  return sum / static_cast<double>(episodes.size());
}

// One update of the network's weights, or of the contact's coefficients, by the loss of the fit
// frames that are not held back.
void LevelFit::StepNetwork() {
  const LevelNetwork network(network_, twin_, NetworkBase(corrections_.contact()),
                             corrections_.weights());
  const SpringMassSystem& system = network.corrected();
  const double score = HeldBackError(system);
  status_ = fmt::format("level {}, network: {:.3f} mm on held-back frames", level_, 1e3 * score);
  if (!corrections_.Judge(score)) {
    BeginSprings();
    return;
  }
  const LiftedMotion motion(twin_, level_, held_back_.FitEpisodes(),
                            MotionOptions(options_.threads));
  const std::optional<LiftedLoss> loss = ComputeLiftedLoss(motion, system);
  if (!loss) {
    corrections_.TurnBack();
  } else if (corrections_.is_turn_of_weights()) {
    corrections_.Update(network.Adjoint(loss->gradient));
  } else {
    Features springs_bar, system_bar;  // of the same logits
    CorrectionsAdjoint(system, loss->gradient, &springs_bar, &system_bar);
    corrections_.Update(system_bar.rightCols(2).transpose());
  }
}

void LevelFit::StepSprings() {
  const Parameters parameters = SpringParameters();
  LiftedMotion::Options motion_options = MotionOptions(options_.threads);
  motion_options.rollout.growth_limit = std::numeric_limits<double>::infinity();
  MotionProblem problem(
      parameters,
      LiftedMotion(twin_, level_, FitEpisodes(data_, kMostSpringRecordings), motion_options),
      DirectionDifference(data_.recordings[0], options_.single_precision));
  const GaussNewtonState before{springs_, damping_, mean_square_, false};
  GaussNewtonOptions options = SpringPrior(parameters);
  options.conjugate_gradient_steps = kLevelConjugateGradients;
  const GaussNewtonState after = GaussNewtonStep(&problem, before, options);
  springs_ = after.x;
  damping_ = after.damping;
  mean_square_ = after.mean_square;
  if (options_.substeps > 0 && !std::isfinite(mean_square_)) {
    throw Error(fmt::format("level {} diverges: {} sub-steps a frame are too few", level_,
                            options_.substeps));
  }
  status_ = fmt::format("level {}, single springs: root mean square {:.3f} mm", level_,
                        PointMillimetres(mean_square_));
  const bool slow = iteration_ > 0 && after.mean_square > 0.99 * before.mean_square;
  if (++iteration_ >= kLevelGaussNewtonSteps || after.converged || slow) stage_ = Stage::kDone;
}

bool LevelFit::Step(int threads) {
  options_.threads = threads;
  switch (stage_) {
    case Stage::kCommon:
      StepCommon();
      return true;
    case Stage::kNetwork:
      StepNetwork();
      return true;
    case Stage::kSprings:
      StepSprings();
      return true;
    case Stage::kDone:
      return false;
  }
  return false;
}

std::string LevelFit::Part() const {
  switch (stage_) {
    case Stage::kCommon:
      return "common factors of coarse levels";
    case Stage::kNetwork:
      return "network";
    case Stage::kSprings:
    case Stage::kDone:
      return "single springs of coarse levels";
  }
  return "";
}

double LevelFit::Progress() const {
  switch (stage_) {
    case Stage::kCommon:
      return 0.2 * (gain_ - kFirstGain) / (kLastGain - kFirstGain + 1);
    case Stage::kNetwork:
      return 0.2 + 0.2 * corrections_.Progress();
    case Stage::kSprings:
      return 0.4 + 0.6 * iteration_ / kLevelGaussNewtonSteps;
    case Stage::kDone:
      return 1;
  }
  return 0;
}

double LevelFit::ProgressOfTrial() const {
  if (stage_ != Stage::kCommon || gain_ == kLastGain) return 1;
  return (gain_ - kFirstGain + static_cast<double>(iteration_) / kLevelStepsPerGain) /
         (kLastGain - kFirstGain);
}

StateArrays LevelFit::Save() const {
  StateArrays arrays = {
      {"train/level/counters", StoreCounters({static_cast<int>(stage_), iteration_, gain_})},
      {"train/level/scalars", StoreVector(Eigen::Vector2d(damping_, mean_square_))},
      {"train/level/common", StoreVector(common_)},
      {"train/level/springs", StoreVector(springs_)}};
  corrections_.Save(stage_ == Stage::kNetwork, &arrays);
  return arrays;
}

void LevelFit::Load(const StateArrays& state) {
  const std::vector<int> counters = LoadCounters(state, "level/counters", 3);
  stage_ = static_cast<Stage>(counters[0]);
  iteration_ = counters[1];
  gain_ = counters[2];
  const Eigen::VectorXd scalars = LoadVector(state, "level/scalars", 2);
  damping_ = scalars[0];
  mean_square_ = scalars[1];
  common_ = LoadVector(state, "level/common", common_.size());
  corrections_.Load(stage_ == Stage::kNetwork, state);
  if (stage_ == Stage::kSprings || stage_ == Stage::kDone) {
    springs_ = LoadVector(state, "level/springs", SpringParameters().size());
  }
}

SpringMassSystem LevelFit::System() const {
  switch (stage_) {
    case Stage::kCommon:
      return CommonParameters().Apply(common_);
    case Stage::kNetwork:
      return CorrectedSystem();
    case Stage::kSprings:
    case Stage::kDone:
      return SpringParameters().Apply(springs_);
  }
  return twin_.levels[level_].system;
}

int LevelFit::SubstepsPerSecond() const {
  const double fps = data_.recordings[0].fps;
  const int substeps = options_.substeps > 0
                           ? options_.substeps
                           : StableSubsteps(ComputeStabilityBound(System()), 1 / fps, kStepSafety);
  return static_cast<int>(std::ceil(substeps * fps));
}

}  // namespace physpring
