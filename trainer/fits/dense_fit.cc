// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/dense_fit.h"

#include <cmath>

#include "trainer/bodies/candidates.h"
#include "trainer/data/held_back.h"
#include "trainer/fits/body_choice.h"
#include "trainer/fits/chain_fit.h"
#include "trainer/fits/factor_fit.h"
#include "trainer/fits/smooth_fit.h"
#include "trainer/fits/spring_fit.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr int kMostCommonRecordings = 4;  // common factors are fitted to no more than these
constexpr GainSchedule kAllGains{0, 6};
// Parts of the work, as measured on recordings of 80 to 500 particles.
constexpr double kChosen = 0.45, kCommon = 0.5;

Twin TwinOf(const SpringMassSystem& system, const Body& body, const FitData& data,
            const TrainOptions& options) {
  const Recording& first = data.recordings[0];
  const int substeps = options.substeps > 0 ? options.substeps
                                            : StableSubsteps(ComputeStabilityBound(system),
                                                             1 / first.fps, kStepSafety);
  Twin twin = DenseTwin(first, system, body.controller_velocity, options.seed);
  twin.levels[0].substeps_per_second = static_cast<int>(std::ceil(substeps * first.fps));
  return twin;
}

}  // namespace

Twin FitDense(const FitData& data, const TrainOptions& options, const Work& work) {
  const Recording& first = data.recordings.at(0);
  const Body simplest = CandidateBodies(first, options)[0];
  work.Reached(TwinOf(StartSystem(first, simplest, kSoftestStart), simplest, data, options));

  const BodyChoice choice = ChooseBody(data, options, work.Part("choosing the model", 0, kChosen));
  ChosenBody model = choice.model;
  const Body& body = model.body;
  work.Reached(TwinOf(model.System(first), body, data, options));

  const bool has_springs = choice.springs.size() > 0 && GaussNewtonSteps(options) > 0;
  if (!body.kind->has_single_springs()) {
    model = FitChain(model, data, options, work.Part("chain", kChosen, 1));
  } else if (options.method == TrainOptions::Method::kSmooth) {
    return TwinOf(FitSmoothBody(model, FitEpisodes(data, kMostCommonRecordings), options,
                                work.Part("smooth body", kChosen, 1)),
                  body, data, options);
  } else if (!has_springs) {
    model.factors = model.start;
    model = FitCommonFactors(model, FitEpisodes(data, kMostCommonRecordings), options, kAllGains,
                             work.Part("common factors", kChosen, kCommon));
  }

  const Parameters springs = SpringFactors(model.System(first), first, *body.kind);
  Eigen::VectorXd x = has_springs ? choice.springs : Eigen::VectorXd::Zero(springs.size());
  work.Reached(TwinOf(springs.Apply(x), body, data, options));
  if (body.kind->has_single_springs()) {
    x = FitSprings(model, data, options, x, work.Part("single springs", kCommon, 1));
  }
  return TwinOf(springs.Apply(x), body, data, options);
}

}  // namespace physpring
