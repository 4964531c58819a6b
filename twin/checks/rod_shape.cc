// SPDX-License-Identifier: Apache-2.0
#include "twin/checks/rod_shape.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

namespace physpring {
namespace {

constexpr double kMostStretched = 1.25;  // times as long, or as short
constexpr double kFarApart = 3;          // times as far as the nearest

}  // namespace

std::string OddRod(const Recording& recording, const MotionScale& scale) {
  const Rod& rod = recording.rod;
  if (rod.edges.empty()) return "";
  const RodLengths lengths(rod);
  std::vector<double> ratios, apart;
  for (const auto& [a, b] : rod.edges) {
    const double seen = (recording.start.col(b) - recording.start.col(a)).norm();
    if (!(seen > 0)) continue;
    apart.push_back(seen);
    ratios.push_back(lengths.Between(a, b, recording.rest) / seen);
  }
  if (ratios.empty()) return "";
  const double ratio = Median(std::move(ratios)), distance = Median(std::move(apart));
  if (distance > kFarApart * scale.spacing) {
    return fmt::format(
        "columns that follow each other along the rod are {:.3g} m apart, but the nearest are "
        "{:.3g} m: do `order` and `rod` go along the object?",
        distance, scale.spacing);
  }
  if (ratio > kMostStretched || ratio < 1 / kMostStretched) {
    return fmt::format(
        "the rod is {:.3g} times as long as in frame 0: are `order` and `rest` in metres, and of "
        "this object?",
        ratio);
  }
  return "";
}

}  // namespace physpring
