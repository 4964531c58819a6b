// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/noise_floor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace physpring {

double MeasurementNoise(const std::vector<const Recording*>& recordings) {
  std::vector<double> differences;
  for (const Recording* recording : recordings) {
    const std::vector<Points>& p = recording->points;
    for (std::size_t t = 5; t < p.size(); ++t) {  // frame 0 may be exact
      const Points fourth = p[t] - 4 * p[t - 1] + 6 * p[t - 2] - 4 * p[t - 3] + p[t - 4];
      for (double difference : fourth.reshaped()) {
        if (!std::isnan(difference)) differences.push_back(std::abs(difference));
      }
    }
  }
  if (differences.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = differences.begin() + static_cast<long>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  constexpr double kMedian = 0.6745;  // the median of |z|, for normal z of deviation 1
  return *middle / (kMedian * std::sqrt(70.0));
}

double TrackNoiseFloor(double noise) { return noise * std::sqrt(8 / std::numbers::pi); }

}  // namespace physpring
