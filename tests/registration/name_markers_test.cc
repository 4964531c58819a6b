// SPDX-License-Identifier: Apache-2.0
#include "registration/name_markers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "tests/support/random_system.h"

namespace physpring {
namespace {

// What an assignment costs.
double CostOf(const Points& markers, const Points& cloud, double reach,
              const std::vector<int>& named) {
  double cost = 0;
  for (Eigen::Index i = 0; i < markers.cols(); ++i) {
    const int j = named[static_cast<std::size_t>(i)];
    const double squared = j < 0 ? reach * reach : (markers.col(i) - cloud.col(j)).squaredNorm();
    cost += std::min(squared, reach * reach);
  }
  return cost;
}

TEST(NameMarkers, FindsTheCheapestOfAllAssignments) {
  constexpr int kMarkers = 4, kPoints = 5;
  constexpr double kReach = 0.9;
  Random random(3);
  for (int round = 0; round < 50; ++round) {
    const Points markers = random.Box(kMarkers, 1), cloud = random.Box(kPoints, 1);
    const std::vector<int> named = NameMarkers(markers, cloud, kReach);
    std::vector<int> order(kPoints);
    std::iota(order.begin(), order.end(), 0);
    double least = std::numeric_limits<double>::infinity();
    do {
      least = std::min(least, CostOf(markers, cloud, kReach, order));
    } while (std::next_permutation(order.begin(), order.end()));
    EXPECT_NEAR(CostOf(markers, cloud, kReach, named), least, 1e-12);
    for (int i = 0; i < kMarkers; ++i) {
      const int j = named[static_cast<std::size_t>(i)];
      if (j < 0) continue;
      EXPECT_EQ(std::count(named.begin(), named.end(), j), 1);
      EXPECT_LT((markers.col(i) - cloud.col(j)).norm(), kReach);
    }
  }
}

TEST(NameMarkers, NamesNothingThatIsFar) {
  Points markers(3, 2), cloud(3, 1);
  markers << 0, 1, 0, 0, 0, 0;
  cloud << 0.9, 0, 0;
  EXPECT_EQ(NameMarkers(markers, cloud, 0.5), (std::vector<int>{-1, 0}));
  EXPECT_EQ(NameMarkers(markers, cloud, 0.05), (std::vector<int>{-1, -1}));
  EXPECT_EQ(NameMarkers(markers, Points(3, 0), 1), (std::vector<int>{-1, -1}));
}

}  // namespace
}  // namespace physpring
