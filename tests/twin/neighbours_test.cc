// SPDX-License-Identifier: Apache-2.0
#include "twin/neighbours.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/random_system.h"

namespace physpring {
namespace {

using Eigen::Vector3d;

// All points, nearest first, equally near ones by index.
std::vector<Neighbour> Sorted(const Points& points, const Vector3d& query) {
  std::vector<Neighbour> all;
  for (int i = 0; i < points.cols(); ++i) all.push_back({i, (points.col(i) - query).norm()});
  std::stable_sort(all.begin(), all.end(),
                   [](const Neighbour& a, const Neighbour& b) { return a.distance < b.distance; });
  return all;
}

void ExpectSame(const std::vector<Neighbour>& found, const std::vector<Neighbour>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].index, expected[i].index) << i;
    EXPECT_DOUBLE_EQ(found[i].distance, expected[i].distance) << i;
  }
}

TEST(Neighbours, NearestAreThoseOfAFullSearch) {
  Random random(1);
  const Points points = random.Box(500, 1), queries = random.Box(50, 1.2);
  const NeighbourSearch search(points);
  for (int q = 0; q < queries.cols(); ++q) {
    for (int count : {1, 7, 100}) {
      std::vector<Neighbour> expected = Sorted(points, queries.col(q));
      expected.resize(count);
      ExpectSame(search.Nearest(queries.col(q), count), expected);
    }
  }
}

TEST(Neighbours, WithinAreThoseOfAFullSearch) {
  Random random(2);
  const Points points = random.Box(500, 1), queries = random.Box(50, 1.2);
  const NeighbourSearch search(points);
  for (int q = 0; q < queries.cols(); ++q) {
    std::vector<Neighbour> expected = Sorted(points, queries.col(q));
    std::erase_if(expected, [](const Neighbour& n) { return n.distance >= 0.3; });
    ExpectSame(search.Within(queries.col(q), 0.3), expected);
  }
}

// 5 x 5 x 5 points 1 m apart: 6 are equally near to an inner one.
Points Grid() {
  Points points(3, 125);
  for (int i = 0; i < 125; ++i) {
    points.col(i) = Eigen::Vector3i(i % 5, i / 5 % 5, i / 25).cast<double>();
  }
  return points;
}

TEST(Neighbours, EquallyNearOnesComeByIndex) {
  const NeighbourSearch search(Grid());
  const std::vector<Neighbour> found = search.Nearest({2, 2, 2}, 4);
  const int middle = 2 + 5 * 2 + 25 * 2;
  ExpectSame(found, {{middle, 0}, {middle - 25, 1}, {middle - 5, 1}, {middle - 1, 1}});
}

TEST(Neighbours, ThereAreNoMoreThanThePoints) {
  const NeighbourSearch search(Grid());
  EXPECT_EQ(search.Nearest({0, 0, 0}, 1000).size(), 125);
  EXPECT_TRUE(search.Nearest({0, 0, 0}, 0).empty());
  EXPECT_TRUE(NeighbourSearch(Points(3, 0)).Nearest({0, 0, 0}, 3).empty());
  EXPECT_TRUE(NeighbourSearch(Points(3, 0)).Within({0, 0, 0}, 3).empty());
}

TEST(Neighbours, AtTheRadiusIsNotWithinIt) {
  const NeighbourSearch search(Grid());
  EXPECT_EQ(search.Within({2, 2, 2}, 1).size(), 1);
  EXPECT_EQ(search.Within({2, 2, 2}, 1.001).size(), 7);
}

TEST(Neighbours, CoincidentPointsAreAllFound) {
  const Points points = Points::Zero(3, 40);  // more than a leaf of the tree holds
  const std::vector<Neighbour> found = NeighbourSearch(points).Nearest({0, 0, 0}, 3);
  ExpectSame(found, {{0, 0}, {1, 0}, {2, 0}});
}

TEST(Neighbours, PairsWithinAreThoseOfAFullSearch) {
  const Points points = Random(3).Box(300, 1);
  std::vector<std::array<int, 2>> expected;
  for (int i = 0; i < 300; ++i) {
    for (int j = i + 1; j < 300; ++j) {
      if ((points.col(i) - points.col(j)).norm() < 0.2) expected.push_back({i, j});
    }
  }
  ASSERT_GT(expected.size(), 100);
  EXPECT_EQ(PairsWithin(points, 0.2), expected);
  EXPECT_TRUE(PairsWithin(Points(3, 0), 0.2).empty());
}

}  // namespace
}  // namespace physpring
