// SPDX-License-Identifier: Apache-2.0
#include "trainer/make_fitter.h"

#include <utility>

#include "trainer/full_fit.h"
#include "trainer/two_stage.h"

namespace physpring {

std::unique_ptr<Fitter> MakeFitter(FitData data, const TrainOptions& options) {
  if (options.method == TrainOptions::Method::kTwoStage) {
    return std::make_unique<TwoStageFit>(std::move(data), options);
  }
  return std::make_unique<FullFit>(std::move(data), options);
}

}  // namespace physpring
