// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/block_bootstrap.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace physpring {
namespace {

constexpr std::size_t kFewestBlocks = 4;  // all draws of one or two are much alike

}  // namespace

std::vector<double> Difference(const std::vector<double>& p, const std::vector<double>& q) {
  std::vector<double> difference;
  for (std::size_t i = 0; i < std::min(p.size(), q.size()); ++i) {
    difference.push_back(p[i] - q[i]);
  }
  return difference;
}

BootstrapResult BlockBootstrap(const std::vector<double>& difference, int block, int draws,
                               std::uint64_t seed) {
  BootstrapResult result;
  const std::size_t count = difference.size();
  if (count == 0 || draws < 1) return result;
  const std::size_t longest = std::max<std::size_t>(1, count / kFewestBlocks);
  const std::size_t length = std::clamp<std::size_t>(static_cast<std::size_t>(block), 1, longest);
  const auto mean = [&](double sum) { return sum / static_cast<double>(count); };
  result.mean = mean(std::accumulate(difference.begin(), difference.end(), 0.0));
  std::mt19937_64 generator(seed);
  std::vector<double> means;
  for (int draw = 0; draw < draws; ++draw) {
    double sum = 0;
    for (std::size_t drawn = 0; drawn < count;) {
      // a block from any frame on, around the end
      const std::size_t start = generator() % count;
      for (std::size_t i = 0; i < length && drawn < count; ++i, ++drawn) {
        sum += difference[(start + i) % count];
      }
    }
    means.push_back(mean(sum));
  }
  double spread = 0;
  for (double drawn : means) spread += (drawn - result.mean) * (drawn - result.mean);
  result.error = std::sqrt(spread / static_cast<double>(means.size()));
  std::sort(means.begin(), means.end());
  const auto at = [&](double share) {
    return means[static_cast<std::size_t>(share * static_cast<double>(means.size() - 1))];
  };
  result.low = at(0.025);
  result.high = at(0.975);
  const auto below = std::upper_bound(means.begin(), means.end(), 0.0) - means.begin();
  result.p = (static_cast<double>(below) + 1) / (draws + 1.0);
  return result;
}

}  // namespace physpring
