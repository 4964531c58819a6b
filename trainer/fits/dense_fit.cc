// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/dense_fit.h"

#include <algorithm>
#include <cmath>

#include "trainer/bodies/candidates.h"
#include "trainer/data/held_back.h"
#include "trainer/fits/body_choice.h"
#include "trainer/fits/chain_fit.h"
#include "trainer/fits/clock_fit.h"
#include "trainer/fits/material_estimate.h"
#include "trainer/fits/net_fit.h"
#include "trainer/fits/posterior_estimate.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr int kMostPosteriorRecordings = 4;

// Parts of the work, as measured on recordings of 80 to 500 particles.
constexpr double kChosen = 0.25, kFitted = 0.9;
constexpr double kClocks = 0.25;  // of recordings of two clocks

Twin TwinOf(const SpringMassSystem& system, const Body& body, const FitData& data,
            const TrainOptions& options) {
  const Recording& first = data.recordings[0];
  const FrameCut cut = CutFrames(1 / first.fps, options.substeps, system);
  Twin twin = DenseTwin(first, system, body.controller_velocity, options.seed);
  twin.levels[0].system.dashpot_stages = cut.dashpot_stages;
  twin.levels[0].substeps_per_second = static_cast<int>(std::ceil(cut.substeps * first.fps));
  return twin;
}

bool HaveTwoClocks(const FitData& data) {
  return std::any_of(data.recordings.begin(), data.recordings.end(), [](const Recording& one) {
    return one.two_clocks && one.controller_count() > 0;
  });
}

// The chosen body, fitted as its kind is.
FittedNet FitBody(const ChosenBody& chosen, const FitData& data, const TrainOptions& options,
                  const Work& work) {
  if (chosen.body.kind->has_single_springs()) {
    return FitNet(chosen, data, options, work.Part("net", kChosen, kFitted));
  }
  const ChosenBody chain = FitChain(chosen, data, options, work.Part("chain", kChosen, kFitted));
  return {chain.System(data.recordings[0]), chain.body, options.substeps};
}

Twin FitByOneClock(const FitData& data, const TrainOptions& options, const Work& work) {
  const Recording& first = data.recordings[0];
  const ChosenBody chosen = ChooseBody(data, options, work.Part("choosing the model", 0, kChosen));
  work.Reached(TwinOf(chosen.System(first), chosen.body, data, options));

  const auto [system, body, substeps] = FitBody(chosen, data, options, work);
  TrainOptions finished = options;
  finished.substeps = substeps;
  Twin twin = TwinOf(system, body, data, finished);
  work.Reached(twin);
  if (!body.kind->has_single_springs()) return twin;  // a chain: its samples predicted badly
  const EstimatedPosterior posterior =
      EstimatePosterior(system, body, FitEpisodes(data, kMostPosteriorRecordings), finished,
                        work.Part("posterior", kFitted, 1));
  twin.posterior = posterior.samples;
  twin.material = EstimateMaterial(system, posterior.intervals);
  return twin;
}

}  // namespace

Twin FitDense(const FitData& data, const TrainOptions& options, const Work& work) {
  const Recording& first = data.recordings.at(0);
  const Body simplest = CandidateBodies(first, options)[0];
  const Twin start = TwinOf(StartSystem(first, simplest, kSoftestStart), simplest, data, options);
  work.Reached(start);
  if (!HaveTwoClocks(data)) return FitByOneClock(data, options, work);

  Twin clock = start;
  clock.clock_offset = FitClockOffset(data, options, work.Part("clocks", 0, kClocks));
  work.Reached(clock);
  Twin twin = FitByOneClock(ByClockOf(clock, data), options, work.Stretch("by one", kClocks, 1));
  twin.clock_offset = clock.clock_offset;
  return twin;
}

}  // namespace physpring
