// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/free_motion_descent.h"

#include <array>
#include <cmath>

#include "trainer/fits/free_motion_error.h"
#include "twin/parallel.h"

namespace physpring {
namespace {

constexpr double kLongDifference = 0.1;  // how far an entry is moved either way
// The lengths of a step that are tried.
constexpr std::array<double, 4> kLengths = {0.1, 0.2, 0.4, 0.8};
// A step that leaves more than this part of the error is the last one.
constexpr double kLeastGain = 0.995;

}  // namespace

FreeMotionDescent DescendFreeMotions(const ChosenBody& model, const std::vector<int>& entries,
                                     const std::vector<Episode>& episodes,
                                     const TrainOptions& options, const FreeMotionDescent& state) {
  const FreeMotionError error(model, episodes, options);
  FreeMotionDescent next = state;
  next.converged = true;
  if (!std::isfinite(next.error)) next.error = error(next.factors);

  const auto count = static_cast<Eigen::Index>(entries.size());
  Eigen::VectorXd sides(2 * count);  // up, then down
  ParallelFor(static_cast<int>(2 * count), options.threads, [&](int i) {
    Eigen::VectorXd moved = state.factors;
    moved[entries[static_cast<std::size_t>(i % count)]] +=
        i < count ? kLongDifference : -kLongDifference;
    sides[i] = std::log(error(moved));
  });
  Eigen::VectorXd slope = sides.head(count) - sides.tail(count);
  slope = slope.array().isFinite().select(slope, 0);
  if (slope.isZero(0)) return next;

  std::array<Eigen::VectorXd, kLengths.size()> points;
  std::array<double, kLengths.size()> errors;
  ParallelFor(static_cast<int>(kLengths.size()), options.threads, [&](int i) {
    points[i] = state.factors;
    for (Eigen::Index k = 0; k < count; ++k) {
      points[i][entries[static_cast<std::size_t>(k)]] -= kLengths[i] * slope[k] / slope.norm();
    }
    errors[i] = error(points[i]);
  });
  const double before = next.error;
  for (std::size_t i = 0; i < kLengths.size(); ++i) {
    if (!(errors[i] < next.error)) continue;
    next.error = errors[i];
    next.factors = points[i];
  }
  next.converged = next.error > kLeastGain * before;
  return next;
}

}  // namespace physpring
