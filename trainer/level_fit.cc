// SPDX-License-Identifier: Apache-2.0
#include "trainer/level_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "trainer/fit_model.h"
#include "trainer/levenberg_marquardt.h"
#include "trainer/lifted_loss.h"
#include "trainer/lifted_problem.h"
#include "trainer/network/level_network.h"
#include "trainer/observer.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr int kMostLevelRecordings = 4;  // that common factors are fitted to
constexpr int kMostSpringRecordings = 12;
constexpr int kFirstGain = 1;  // of kObserverGains: a Galerkin projection is not far off
constexpr int kLastGain = static_cast<int>(kObserverGains.size()) - 1;
constexpr int kStepsPerGain = 4;
constexpr int kPatience = 5;  // epochs without gain on held-back frames
constexpr int kGaussNewtonSteps = 6;
constexpr int kLevelConjugateGradients = 12;

// Of a frame: never more than level 0 needs.
int MostSubsteps(const TwinLevel& dense, double fps) {
  return std::max(StableSubsteps(ComputeStabilityBound(dense.system), 1 / fps, kStepSafety),
                  static_cast<int>(std::ceil(dense.substeps_per_second / fps)));
}

void StoreAdam(const std::string& name, const Adam& adam, StateArrays* arrays) {
  const std::string prefix = "train/level/" + name + "_adam";
  (*arrays)[prefix + "/steps"] = StoreCounters({adam.steps});
  (*arrays)[prefix + "/mean"] = StoreVector(adam.mean);
  (*arrays)[prefix + "/mean_square"] = StoreVector(adam.mean_square);
}

void LoadAdam(const std::string& name, const StateArrays& arrays, Adam* adam) {
  const std::string prefix = "level/" + name + "_adam";
  adam->steps = LoadCounters(arrays, prefix + "/steps", 1)[0];
  adam->mean = LoadVector(arrays, prefix + "/mean", adam->mean.size());
  adam->mean_square = LoadVector(arrays, prefix + "/mean_square", adam->mean_square.size());
}

// Of points, from the mean square of their coordinates' residuals.
double Millimetres(double mean_square) { return 1e3 * std::sqrt(3 * mean_square); }

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
      weights_(weights),
      contact_(Eigen::VectorXd::Zero(2)),
      weights_adam_(weights.size()),
      contact_adam_(2),
      best_weights_(weights),
      best_contact_(contact_) {}

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
  SpringMassSystem base = NetworkBase(best_contact_);
  if (options_.network.epochs == 0) return base;
  return LevelNetwork(network_, twin_, base, best_weights_).corrected();
}

void LevelFit::StepCommon() {
  const Parameters parameters = CommonParameters();
  // the differences run in parallel
  const LiftedMotion motion(twin_, level_, FitEpisodes(data_, kMostLevelRecordings),
                            MotionOptions(1, kObserverGains[gain_]));
  LevenbergMarquardtOptions options;
  options.threads = options_.threads;
  options.difference = FactorDifference(data_.recordings[0]);
  LevenbergMarquardtState state{common_, damping_, mean_square_, false};
  state = LevenbergMarquardtStep(
      [&](const Eigen::VectorXd& x) { return LiftedProblem(parameters, motion, 0).Residuals(x); },
      state, options);
  common_ = state.x;
  damping_ = state.damping;
  mean_square_ = state.mean_square > 0 ? state.mean_square
                                       : std::numeric_limits<double>::infinity();  // it diverges
  status_ = fmt::format("level {}, common factors: {:.3f} mm", level_, Millimetres(mean_square_));
  if (++iteration_ < kStepsPerGain && !state.converged) return;
  iteration_ = 0;
  damping_ = 1e-2;
  if (++gain_ <= kLastGain) return;
  if (options_.network.epochs > 0) {
    BeginNetwork();
  } else {
    BeginSprings();
  }
}

void LevelFit::BeginNetwork() {
  stage_ = Stage::kNetwork;
  weights_ = best_weights_ = network_.WithoutCorrections(weights_);
  iteration_ = best_iteration_ = 0;
  best_score_ = std::numeric_limits<double>::infinity();
  rate_ = 1;
  weights_adam_ = Adam(weights_.size());
  contact_adam_ = Adam(contact_.size());
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
  const auto moved = motion.Run(system, motion.Substeps(system));
  if (!moved) return std::numeric_limits<double>::infinity();
  double sum = 0;
  for (std::size_t e = 0; e < episodes.size(); ++e) {
    const Recording& held_back = held_back_.judged[e].held_back;
    sum += MeanTrackError(moved->particles[e], held_back, 1, held_back.train_frames).value_or(0);
  }
  return sum / static_cast<double>(episodes.size());
}

int LevelFit::UpdatesPerEpoch() const {
  const bool contact = data_.recordings[0].ground.has_value();
  return options_.network.updates + (contact ? options_.network.contact_updates : 0);
}

void LevelFit::Keep(double score) {
  best_score_ = score;
  best_weights_ = weights_;
  best_contact_ = contact_;
  best_iteration_ = iteration_;
}

void LevelFit::TurnBack() {
  weights_ = best_weights_;
  contact_ = best_contact_;
}

// One update of the network's weights, or of the contact's coefficients, by the loss of the fit
// frames that are not held back.
void LevelFit::StepNetwork() {
  const LevelNetwork network(network_, twin_, NetworkBase(contact_), weights_);
  const SpringMassSystem& system = network.corrected();
  const double score = HeldBackError(system);
  if (score < best_score_) Keep(score);
  status_ = fmt::format("level {}, network: {:.3f} mm on held-back frames", level_, 1e3 * score);
  const int epoch = iteration_ / UpdatesPerEpoch();
  const bool worse = iteration_ - best_iteration_ >= kPatience * UpdatesPerEpoch();
  if (worse || epoch >= options_.network.epochs) {
    TurnBack();
    BeginSprings();
    return;
  }
  const bool of_weights = iteration_ % UpdatesPerEpoch() < options_.network.updates;
  ++iteration_;
  const LiftedMotion motion(twin_, level_, held_back_.FitEpisodes(),
                            MotionOptions(options_.threads));
  const std::optional<LiftedLoss> loss = ComputeLiftedLoss(motion, system);
  if (!loss) {  // too far: back to the best weights, and on in shorter steps
    TurnBack();
    rate_ /= 4;
    return;
  }
  const double slower = rate_ * std::pow(options_.network.decay, epoch);  // than at first
  if (of_weights) {
    const double rate = slower * options_.network.learning_rate;
    weights_adam_.Step(network.Adjoint(loss->gradient),
                       Eigen::VectorXd::Constant(weights_.size(), rate), &weights_);
    return;
  }
  Features springs_bar, system_bar;  // of the same logits
  CorrectionsAdjoint(system, loss->gradient, &springs_bar, &system_bar);
  const double rate = slower * options_.network.contact_rate;
  contact_adam_.Step(system_bar.rightCols(2).transpose(), Eigen::Vector2d::Constant(rate),
                     &contact_);
}

void LevelFit::StepSprings() {
  const Parameters parameters = SpringParameters();
  LiftedMotion::Options motion_options = MotionOptions(options_.threads);
  motion_options.rollout.growth_limit = std::numeric_limits<double>::infinity();
  const LiftedMotion motion(twin_, level_, FitEpisodes(data_, kMostSpringRecordings),
                            motion_options);
  LiftedProblem problem(parameters, motion,
                        DirectionDifference(data_.recordings[0], options_.single_precision));
  const GaussNewtonState before{springs_, damping_, mean_square_, false};
  GaussNewtonOptions options = SpringPrior(parameters);
  options.conjugate_gradient_steps = kLevelConjugateGradients;
  const GaussNewtonState after = GaussNewtonStep(&problem, before, options);
  springs_ = after.x;
  damping_ = after.damping;
  mean_square_ = after.mean_square;
  status_ = fmt::format("level {}, single springs: {:.3f} mm", level_, Millimetres(mean_square_));
  const bool slow = iteration_ > 0 && after.mean_square > 0.99 * before.mean_square;
  if (++iteration_ >= kGaussNewtonSteps || after.converged || slow) stage_ = Stage::kDone;
}

bool LevelFit::Step() {
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
      return 0.2 + 0.2 * iteration_ / (options_.network.epochs * UpdatesPerEpoch());
    case Stage::kSprings:
      return 0.4 + 0.6 * iteration_ / kGaussNewtonSteps;
    case Stage::kDone:
      return 1;
  }
  return 0;
}

bool LevelFit::can_be_judged() const { return stage_ != Stage::kCommon || gain_ == kLastGain; }

StateArrays LevelFit::Save() const {
  Eigen::VectorXd scalars(4);
  scalars << damping_, mean_square_, best_score_, rate_;
  StateArrays arrays = {
      {"train/level/counters",
       StoreCounters({static_cast<int>(stage_), iteration_, best_iteration_, gain_})},
      {"train/level/scalars", StoreVector(scalars)},
      {"train/level/common", StoreVector(common_)},
      {"train/level/springs", StoreVector(springs_)},
      {"train/level/weights", StoreVector(weights_)},
      {"train/level/best_weights", StoreVector(best_weights_)},
      {"train/level/contact", StoreVector(contact_)},
      {"train/level/best_contact", StoreVector(best_contact_)}};
  if (stage_ == Stage::kNetwork) {
    StoreAdam("weights", weights_adam_, &arrays);
    StoreAdam("contact", contact_adam_, &arrays);
  }
  return arrays;
}

void LevelFit::Load(const StateArrays& state) {
  const std::vector<int> counters = LoadCounters(state, "level/counters", 4);
  stage_ = static_cast<Stage>(counters[0]);
  iteration_ = counters[1];
  best_iteration_ = counters[2];
  gain_ = counters[3];
  const Eigen::VectorXd scalars = LoadVector(state, "level/scalars", 4);
  damping_ = scalars[0];
  mean_square_ = scalars[1];
  best_score_ = scalars[2];
  rate_ = scalars[3];
  common_ = LoadVector(state, "level/common", common_.size());
  weights_ = LoadVector(state, "level/weights", weights_.size());
  best_weights_ = LoadVector(state, "level/best_weights", weights_.size());
  contact_ = LoadVector(state, "level/contact", contact_.size());
  best_contact_ = LoadVector(state, "level/best_contact", contact_.size());
  if (stage_ == Stage::kNetwork) {
    LoadAdam("weights", state, &weights_adam_);
    LoadAdam("contact", state, &contact_adam_);
  }
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
