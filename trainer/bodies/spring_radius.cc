// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/spring_radius.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "twin/neighbours.h"

namespace physpring {
namespace {

constexpr double kFewer = 0.8, kMore = 1.25;  // neighbours that will do, relative to those wanted
constexpr double kInner = 0.25;               // this part of the particles, the densest, are inner
constexpr double kBlur = 0.03;  // noise makes a distance uncertain by at least this part of it
constexpr int kTrials = 60;

// The distance within which inner particles have `neighbours` others.
double InnerDistance(std::vector<std::vector<double>>* sorted, double neighbours) {
  std::vector<double> distances;
  for (const std::vector<double>& own : *sorted) {
    const auto last = static_cast<double>(own.size() - 1);
    distances.push_back(own[static_cast<std::size_t>(std::clamp(neighbours - 1, 0.0, last))]);
  }
  const auto inner = distances.begin() + static_cast<long>(kInner * (distances.size() - 1));
  std::nth_element(distances.begin(), inner, distances.end());
  return *inner;
}

}  // namespace

double SpringRadius(const Points& particles, int neighbours) {
  const int most = static_cast<int>(std::ceil(kMore * neighbours)) + 1;
  const NeighbourSearch search(particles);
  std::vector<std::vector<double>> sorted(particles.cols());
  std::vector<double> all;
  for (int i = 0; i < particles.cols(); ++i) {
    for (const Neighbour& near : search.Nearest(particles.col(i), most + 1)) {
      if (near.index == i) continue;
      sorted[i].push_back(near.distance);
      all.push_back(near.distance);
    }
  }
  std::sort(all.begin(), all.end());
  const double least = InnerDistance(&sorted, std::max(1.0, std::floor(kFewer * neighbours)));
  const double greatest = InnerDistance(&sorted, most);

  // the middle of the longest run of radii that the fewest pairs are near to
  double best = least;
  std::ptrdiff_t fewest = static_cast<std::ptrdiff_t>(all.size()) + 1;
  int longest = 0, run = 0;
  std::ptrdiff_t previous = -1;
  for (int trial = 0; trial <= kTrials; ++trial) {
    const double radius =
        (1 + kBlur) * least * std::pow(greatest / least, static_cast<double>(trial) / kTrials);
    const std::ptrdiff_t near = std::lower_bound(all.begin(), all.end(), radius * (1 + kBlur)) -
                                std::lower_bound(all.begin(), all.end(), radius * (1 - kBlur));
    run = near == previous ? run + 1 : 1;
    previous = near;
    if (near > fewest || (near == fewest && run <= longest)) continue;
    fewest = near;
    longest = run;
    best = radius * std::pow(least / greatest, 0.5 * (run - 1) / kTrials);
  }
  return best;
}

}  // namespace physpring
