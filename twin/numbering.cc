// SPDX-License-Identifier: Apache-2.0
#include "twin/numbering.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "twin/neighbours.h"

namespace physpring {
namespace {

// An object may be stretched where it starts, but neighbours of which so many are so many times as
// far apart are none.
constexpr double kStretched = 2, kShare = 0.25;
constexpr int kComparedNeighbours = 3;

using Pairs = std::vector<std::array<int, 2>>;

double Distance(const Points& points, const std::array<int, 2>& pair) {
  return (points.col(pair[0]) - points.col(pair[1])).norm();
}

// The part of pairs that are near in `known` and far apart in `start`.
double ShareStretched(const Pairs& near, const Points& known, const Points& start) {
  const auto stretched = std::count_if(near.begin(), near.end(), [&](const auto& pair) {
    return Distance(start, pair) > kStretched * Distance(known, pair);
  });
  return near.empty() ? 0 : static_cast<double>(stretched) / static_cast<double>(near.size());
}

Pairs NearestPairs(const Points& points) {
  const NeighbourSearch search(points);
  Pairs pairs;
  for (int i = 0; i < static_cast<int>(points.cols()); ++i) {
    for (const Neighbour& neighbour : search.Nearest(points.col(i), kComparedNeighbours + 1)) {
      if (neighbour.index != i) pairs.push_back({i, neighbour.index});
    }
  }
  return pairs;
}

// A fold that opens, or closes, parts neighbours one way only: other numbers do both ways.
std::string Judge(const Pairs& near, const Points& known, const Points& start,
                  const std::string& other) {
  if (known.cols() != start.cols()) return "";  // another object, of which others complain
  const double share = ShareStretched(near, known, start);
  if (share <= kShare || ShareStretched(NearestPairs(start), start, known) <= kShare) return "";
  return fmt::format(
      "{:.0f} % of neighbours in {} start more than {:g} times as far apart: are the points and "
      "controllers numbered alike in both?",
      100 * share, other, kStretched);
}

}  // namespace

std::string OddNumbering(const Recording& first, const Recording& recording) {
  return Judge(NearestPairs(first.start), first.start, recording.start, first.name);
}

std::string OddNumbering(const Twin& twin, const Recording& recording) {
  const SpringMassSystem& system = twin.levels[0].system;
  return Judge(system.springs, system.position, recording.start, "the twin");
}

}  // namespace physpring
