// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/train.h"

#include "trainer/fits/dense_fit.h"
#include "trainer/fits/force_scale.h"
#include "trainer/fits/hierarchy_fit.h"
#include "trainer/fits/two_stage.h"

namespace physpring {
namespace {

constexpr double kDensePart = 0.5;  // level 0's part of the work where there are more levels

Twin Level0Of(const Twin& twin, const Work& work) {
  Twin dense = twin;
  dense.levels.resize(1);
  work.Reached(dense);
  return dense;
}

}  // namespace

Twin Train(const FitData& data, const TrainOptions& options, const std::optional<Twin>& dense,
           const Work& work) {
  ExpectCoarserLevels(data, options);
  const Work of_level0 = work.Part("level 0", 0, options.levels == 1 ? 1 : kDensePart);
  const bool two_stage = options.method == TrainOptions::Method::kTwoStage;
  Twin twin = dense       ? Level0Of(*dense, work)
              : two_stage ? FitTwoStage(data, options, of_level0)
                          : FitDense(data, options, of_level0);
  const FitData by_its_clock = ByClockOf(twin, data);
  if (!dense) twin.linear = FitLinearPredictor(by_its_clock.recordings);
  if (options.levels > 1) {
    work.Reached(twin);
    twin = FitHierarchy(twin, by_its_clock, options, work.Part("coarse levels", kDensePart, 1));
  }
  if (!twin.force_scale) ScaleToForces(by_its_clock, &twin);
  return twin;
}

}  // namespace physpring
