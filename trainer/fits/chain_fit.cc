// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/chain_fit.h"

#include <fmt/format.h>

#include "trainer/data/held_back.h"
#include "trainer/fits/factor_fit.h"
#include "trainer/fits/free_motion_descent.h"
#include "trainer/fits/free_motion_search.h"

namespace physpring {
namespace {

constexpr GainSchedule kChainGains{3, 20};  // the fit goes on from the choice, and takes longer
constexpr int kMostSearchRecordings = 24;   // free motions are fitted on no more than these
constexpr int kDescents = 6;                // most steps of the descent
// Parts of the work at which common factors are done, and the search.
constexpr double kFactorsDone = 0.45, kSearchDone = 0.73;

std::string Status(const ChosenBody& model, double error) {
  return fmt::format("{}, free motions: {:.3f} mm", model.body.Label(), 1e3 * error);
}

struct ChainDescent {
  FreeMotionDescent state;
  int iteration = 0;

  template <class Visitor>
  void Visit(Visitor&& visit) {
    visit(state.factors, state.error, state.converged, iteration);
  }
};

}  // namespace

ChosenBody FitChain(const ChosenBody& chosen, const FitData& data, const TrainOptions& options,
                    const Work& work) {
  ChosenBody model = FitCommonFactors(chosen, FitEpisodes(data, kMostSpringRecordings), options,
                                      kChainGains, work.Part("common factors", 0, kFactorsDone));
  const std::vector<Episode> free = FitEpisodes(data, kMostSearchRecordings);
  const Parameters factors = model.ParametersOf(data.recordings[0]);

  const FreeMotionSearch start(model.factors, factors.WholeBodyEntries(), options.epochs,
                               options.seed);
  const FreeMotionSearch search =
      work.Part("search among free motions", kFactorsDone, kSearchDone)
          .Follow(start, [&](FreeMotionSearch* one) -> StepReport {
            one->Step(model, free, options);
            return {one->done(), one->Progress(), Status(model, one->best_error())};
          });
  model.factors = search.BestFactors();

  const ChainDescent descent =
      work.Part("descent of free motions", kSearchDone, 1)
          .Follow(ChainDescent{{model.factors, search.best_error(), false}},
                  [&](ChainDescent* one) -> StepReport {
                    one->state = DescendFreeMotions(model, factors.AlongBodyEntries(), free,
                                                    options, one->state);
                    ++one->iteration;
                    return {one->iteration >= kDescents || one->state.converged,
                            static_cast<double>(one->iteration) / kDescents,
                            Status(model, one->state.error)};
                  });
  model.factors = descent.state.factors;
  return model;
}

}  // namespace physpring
