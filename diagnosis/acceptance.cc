// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/acceptance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace physpring {
namespace {

// An error below this, times the noise floor, asks for no more effects than were found.
constexpr double kExplainedByEffects = 2;
constexpr double kNearNoise = 3;        // noise floors
constexpr Eigen::Index kFreeForm = 20;  // what has more parameters is a free form
constexpr double kStrong = 0.7, kHopeless = 4;
constexpr double kLeastScore = 0.05;  // the least score of a trace, as a part of the best one
constexpr double kNear = 1.25;      // the largest error that is near, times that of the chosen fit
constexpr double kFitsTell = 0.05;  // smaller differences, in noise floors, fits do not tell
constexpr int kSimplestDraws = 1000;

}  // namespace

bool IsExplained(double error, double noise_floor) { return error < kExplained * noise_floor; }

bool IsUnexplained(double error, double noise_floor) { return error > 2.5 * noise_floor; }

bool IsNearNoise(double error, double noise_floor) { return error < kNearNoise * noise_floor; }

bool NothingIsLeft(int accepted, double error, double noise_floor) {
  return accepted == 0 ? IsExplained(error, noise_floor)
                       : error < kExplainedByEffects * noise_floor;
}

bool IsFreeForm(Eigen::Index parameters) { return parameters > kFreeForm; }

bool CanBeJudged(Eigen::Index parameters, bool judged_in_between) {
  return !judged_in_between || !IsFreeForm(parameters);
}

bool IsSurelyBetter(const BootstrapResult& gain) { return gain.mean > gain.error; }

bool IsAlike(const BootstrapResult& worse) { return worse.mean <= worse.error; }

bool IsStrongLaw(double misfit, double misfit_alone) { return misfit < kStrong * misfit_alone; }

bool IsHopeless(double misfit, double least_misfit) { return misfit > kHopeless * least_misfit; }

bool IsWorthRefit(double score, double best_score) { return score > kLeastScore * best_score; }

bool IsWorthIt(const BootstrapResult& gain, double without, const Threshold& threshold) {
  return WhyNotWorthIt(gain, without, threshold).empty();
}

std::string WhyNotWorthIt(const BootstrapResult& gain, double without, const Threshold& threshold) {
  const double with = std::max(0.0, without - gain.mean), floor = threshold.noise_floor;
  const double excess = std::max(0.0, without * without - floor * floor);
  const double taken = without * without - with * with;
  const double asked_p = threshold.false_alarm / threshold.tried;
  if (!(gain.p < asked_p)) {
    return fmt::format("its gain may be chance: p is {:.2g}, below {:.2g} is asked", gain.p,
                       asked_p);
  }
  if (!(taken > threshold.least_gain * excess)) {
    return fmt::format(
        "it takes {:.0f} % of the squared error above the noise, more than {:.0f} % "
        "are asked",
        100 * taken / excess, 100 * threshold.least_gain);
  }
  if (!(std::sqrt(taken) > threshold.least_noise * floor)) {
    return fmt::format(
        "it takes {:.3g} mm off the error, in squares, more than {:.3g} mm, a part "
        "of the noise, are asked",
        1e3 * std::sqrt(taken), 1e3 * threshold.least_noise * floor);
  }
  return "";
}

bool IsNear(double error, double chosen_error) { return error < kNear * chosen_error; }

std::size_t ChooseSimplest(const std::vector<Scored>& fits, double noise_floor, int block,
                           std::uint64_t seed) {
  const auto least = std::min_element(
      fits.begin(), fits.end(), [](const Scored& p, const Scored& q) { return p.mean < q.mean; });
  auto chosen = static_cast<std::size_t>(least - fits.begin());
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (fits[i].parameters >= fits[chosen].parameters) continue;
    const std::vector<double> worse = Difference(fits[i].held, least->held);
    if (IsExplained(fits[i].mean, noise_floor) ||
        fits[i].mean < least->mean + kFitsTell * noise_floor ||
        IsAlike(BlockBootstrap(worse, block, kSimplestDraws, seed))) {
      chosen = i;
    }
  }
  return chosen;
}

}  // namespace physpring
