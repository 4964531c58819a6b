// SPDX-License-Identifier: Apache-2.0
#include "trainer/make_fitter.h"

#include <utility>

#include "trainer/finished_fit.h"
#include "trainer/full_fit.h"
#include "trainer/hierarchy_fit.h"
#include "trainer/two_stage.h"

namespace physpring {

namespace {

std::unique_ptr<Fitter> MakeDenseFitter(FitData data, const TrainOptions& options) {
  if (options.method == TrainOptions::Method::kTwoStage) {
    return std::make_unique<TwoStageFit>(std::move(data), options);
  }
  return std::make_unique<FullFit>(std::move(data), options);
}

}  // namespace

std::unique_ptr<Fitter> MakeFitter(FitData data, const TrainOptions& options,
                                   const std::optional<Twin>& dense) {
  std::unique_ptr<Fitter> level0 =
      dense ? std::make_unique<FinishedFit>(*dense) : MakeDenseFitter(data, options);
  if (options.levels == 1) return level0;
  return std::make_unique<HierarchyFit>(std::move(data), options, std::move(level0));
}

}  // namespace physpring
