// SPDX-License-Identifier: Apache-2.0
#include "twin/checks/lost_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "twin/checks/motion_scale.h"

namespace physpring {
namespace {

constexpr double kFarFromZero = 10;         // times the median step of the point
constexpr double kLeastFarFromZero = 1e-3;  // m

// How far the point usually moves from one frame to the next, without steps from or to the origin.
double MedianStep(const std::vector<Points>& frames, Eigen::Index i) {
  std::vector<double> steps;
  for (std::size_t t = 1; t < frames.size(); ++t) {
    const auto before = frames[t - 1].col(i), now = frames[t].col(i);
    if (before.isZero(0) || now.isZero(0) || !before.allFinite() || !now.allFinite()) continue;
    steps.push_back((now - before).norm());
  }
  return Median(std::move(steps));
}

// The first frame from `from` on in which the point is at the origin, or is not.
std::size_t NextFrame(const std::vector<Points>& frames, Eigen::Index i, std::size_t from,
                      bool at_origin) {
  while (from < frames.size() && frames[from].col(i).isZero(0) != at_origin) ++from;
  return from;
}

// How many measurements of the point are taken as unseen.
std::size_t TakeZerosOfPoint(Eigen::Index i, std::vector<Points>* frames) {
  std::size_t first = NextFrame(*frames, i, 0, true), lost = 0;
  if (first == frames->size()) return 0;
  const double limit = std::max(kLeastFarFromZero, kFarFromZero * MedianStep(*frames, i));
  const auto is_far = [&](std::size_t t) { return (*frames)[t].col(i).norm() > limit; };
  while (first < frames->size()) {
    const std::size_t end = NextFrame(*frames, i, first, false);
    if ((first > 0 && is_far(first - 1)) || (end < frames->size() && is_far(end))) {
      for (std::size_t t = first; t < end; ++t) {
        (*frames)[t].col(i).setConstant(std::numeric_limits<double>::quiet_NaN());
      }
      lost += end - first;
    }
    first = NextFrame(*frames, i, end, true);
  }
  return lost;
}

}  // namespace

std::string TakeZerosAsUnseen(const std::string& where, std::vector<Points>* frames) {
  if (frames->empty()) return "";
  std::size_t lost = 0, points = 0;
  for (Eigen::Index i = 0; i < frames->front().cols(); ++i) {
    const std::size_t of_point = TakeZerosOfPoint(i, frames);
    lost += of_point;
    points += of_point > 0;
  }
  if (lost == 0) return "";
  return fmt::format("{}: {} measurements of {} points at exactly (0, 0, 0) are taken as not seen",
                     where, lost, points);
}

}  // namespace physpring
