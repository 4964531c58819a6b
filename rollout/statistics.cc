// SPDX-License-Identifier: Apache-2.0
#include "rollout/statistics.h"

#include <algorithm>
#include <cmath>

namespace physpring {

Interval WilsonInterval(int successes, int trials) {
  if (trials == 0) return {};
  constexpr double z = 1.959963984540054;  // 97.5 % quantile of the normal distribution
  const double n = trials, p = successes / n;
  const double centre = (p + z * z / (2 * n)) / (1 + z * z / n);
  const double half = z / (1 + z * z / n) * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n));
  return {std::max(0.0, centre - half), std::min(1.0, centre + half)};
}

double PairedVerdicts::Agreement() const {
  return count() == 0 ? 0 : static_cast<double>(both + neither) / count();
}

std::optional<double> PairedVerdicts::Kappa() const {
  if (count() == 0) return std::nullopt;
  const double n = count();
  const double first = (both + only_first) / n, second = (both + only_second) / n;
  const double chance = first * second + (1 - first) * (1 - second);
  if (chance >= 1) return std::nullopt;
  return (Agreement() - chance) / (1 - chance);
}

double PairedVerdicts::McNemar() const {
  const int discordant = only_first + only_second, fewer = std::min(only_first, only_second);
  // twice the lower tail of a fair coin's binomial distribution
  double tail = 0;
  for (int k = 0; k <= fewer; ++k) {
    tail += std::exp(std::lgamma(discordant + 1) - std::lgamma(k + 1) -
                     std::lgamma(discordant - k + 1) - discordant * std::log(2));
  }
  return std::min(1.0, 2 * tail);
}

std::optional<double> Pearson(const std::vector<double>& first, const std::vector<double>& second) {
  const std::size_t n = first.size();
  if (n < 2) return std::nullopt;
  double mean_a = 0, mean_b = 0;
  for (std::size_t i = 0; i < n; ++i) {
    mean_a += first[i] / static_cast<double>(n);
    mean_b += second[i] / static_cast<double>(n);
  }
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double a = first[i] - mean_a, b = second[i] - mean_b;
    ab += a * b;
    aa += a * a;
    bb += b * b;
  }
  constexpr double kConstant = 1e-24;  // rounding in the squares of rates
  if (aa < kConstant || bb < kConstant) return std::nullopt;
  return ab / std::sqrt(aa * bb);
}

double MeanMaximumRankViolation(const std::vector<double>& reference,
                                const std::vector<double>& tested) {
  double sum = 0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    double worst = 0;
    for (std::size_t j = 0; j < reference.size(); ++j) {
      if ((tested[i] < tested[j]) == (reference[i] < reference[j])) continue;
      worst = std::max(worst, std::abs(reference[i] - reference[j]));
    }
    sum += worst;
  }
  return reference.empty() ? 0 : sum / static_cast<double>(reference.size());
}

}  // namespace physpring
