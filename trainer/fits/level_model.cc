// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/level_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trainer/bodies/factors.h"
#include "trainer/motion/observer.h"
#include "trainer/motion/track_error.h"
#include "trainer/network/level_network.h"
#include "trainer/projection/soften_level.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr int kMostJudgingRecordings = 4;  // frames are held back on no more than these

}  // namespace

LevelModel::LevelModel(const FitData& data, const TrainOptions& options, const Twin& twin,
                       const GraphNetwork& network)
    : data_(data),
      options_(options),
      twin_(twin),
      level_(static_cast<int>(twin.levels.size()) - 1),
      most_substeps_(MostSubstepsOfLevels(twin.levels[0], data.recordings[0].fps)),
      held_back_(HoldBack(data, kMostJudgingRecordings)),
      network_(network) {
  if (options_.substeps > 0) return;
  SoftenLevel(most_substeps_, first().fps, &twin_.levels.back().system);
}

Parameters LevelModel::CommonParameters() const {
  return CommonFactors(twin_.levels.back().system, first());
}

SpringMassSystem LevelModel::NetworkBase(const LevelValues& values) const {
  SpringMassSystem base = CommonParameters().Apply(values.common);
  if (values.contact.isZero(0)) return base;
  Features of_system(1, 1 + kContactCount);
  of_system << 0, values.contact.transpose();
  return ApplyCorrections(base, Features::Zero(base.spring_count(), 2), of_system);
}

SpringMassSystem LevelModel::Corrected(const LevelValues& values) const {
  SpringMassSystem base = NetworkBase(values);
  if (options_.network.epochs == 0) return base;
  return LevelNetwork(network_, twin_, base, values.weights).corrected();
}

LiftedMotion::Options LevelModel::MotionOptions(int threads, double gain) const {
  LiftedMotion::Options motion;
  motion.rollout.single_precision = options_.single_precision;
  motion.rollout.controller_velocity = twin_.controller_velocity;
  motion.rollout.substeps = options_.substeps;
  motion.rollout.observer_gain = gain;
  motion.most_substeps = most_substeps_;
  motion.threads = threads;
  return motion;
}

LiftedMotion LevelModel::Motion(int threads, double gain, int most) const {
  return {twin_, level_, FitEpisodes(data_, most), MotionOptions(threads, gain)};
}

LiftedMotion LevelModel::MotionNotHeldBack() const {
  return {twin_, level_, held_back_.FitEpisodes(), MotionOptions(options_.threads, 0)};
}

LiftedMotion LevelModel::RoughMotion(int most) const {
  LiftedMotion::Options motion = MotionOptions(options_.threads, 0);
  motion.rollout.growth_limit = std::numeric_limits<double>::infinity();
  return {twin_, level_, FitEpisodes(data_, most), motion};
}

double LevelModel::HeldBackError(const SpringMassSystem& system) const {
  const LiftedMotion motion(twin_, level_, held_back_.JudgedEpisodes(),
                            MotionOptions(options_.threads, kObserverGains[kLastGain - 1]));
  const auto moved = motion.Run(system, motion.SubstepsOf(system));
  if (!moved) return std::numeric_limits<double>::infinity();
  double sum = 0;
  for (int e = 0; e < motion.episode_count(); ++e) {
    sum += MeanTrackError(motion.episode(e), FrameUse::kHeld, (*moved)[e].particles());
  }
  return sum / motion.episode_count();
}

TwinLevel LevelModel::LevelOf(const SpringMassSystem& system) const {
  const double fps = first().fps;
  const FrameCut cut = CutFrames(1 / fps, options_.substeps, system);
  TwinLevel level{system, twin_.levels.back().assignment,
                  static_cast<int>(std::ceil(cut.substeps * fps))};
  level.system.dashpot_stages = cut.dashpot_stages;
  return level;
}

}  // namespace physpring
