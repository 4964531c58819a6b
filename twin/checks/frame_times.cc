// SPDX-License-Identifier: Apache-2.0
#include "twin/checks/frame_times.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/QR>
#include <algorithm>
#include <array>

namespace physpring {
namespace {

constexpr std::size_t kFewestOdd = 3;  // frames that are odd for once may be so by chance
constexpr double kFewestOddPart = 0.02;
constexpr int kWindow = 6, kBefore = 3;  // frames that a curve goes through, and those before a gap
constexpr double kFarBetter = 0.5;       // the squared residuals with a gap, times those without
constexpr int kLongestRepetition = 10;   // frames
constexpr std::size_t kNamedFrames = 8;

using Window = Eigen::Matrix<double, kWindow, kWindow>;

bool AreEnough(const std::vector<int>& frames, int of) {
  return frames.size() >= kFewestOdd && static_cast<double>(frames.size()) > kFewestOddPart * of;
}

// What is left of values at the frames of a window once a cubic curve is taken off, if so many
// frames are missing in its middle.
Window ResidualOfCubic(int missing) {
  Eigen::Vector<double, kWindow> time;
  for (int t = 0; t < kWindow; ++t) time[t] = t < kBefore ? t : t + missing;
  time.array() -= time.mean();
  Eigen::Matrix<double, kWindow, 4> powers;
  powers << Eigen::Vector<double, kWindow>::Ones(), time, time.cwiseAbs2(), time.array().cube();
  return Window::Identity() - powers * powers.completeOrthogonalDecomposition().pseudoInverse();
}

// The squared residuals of all that is seen in the whole window that begins at `first`, without a
// gap, and with one or two frames missing.
Eigen::Array3d SquaredResiduals(const Recording& recording, int first) {
  static const std::array<Window, 3> kResiduals{ResidualOfCubic(0), ResidualOfCubic(1),
                                                ResidualOfCubic(2)};
  Eigen::Array3d squares = Eigen::Array3d::Zero();
  const auto add = [&](const std::vector<Points>& frames) {
    for (Eigen::Index i = 0; i < frames[0].cols(); ++i) {
      Eigen::Matrix<double, kWindow, 3> path;
      for (int t = 0; t < kWindow; ++t) path.row(t) = frames[first + t].col(i).transpose();
      if (!path.allFinite()) continue;
      for (int k = 0; k < 3; ++k) squares[k] += (kResiduals[k] * path).squaredNorm();
    }
  };
  add(recording.points);
  add(recording.controllers);
  return squares;
}

// Whether all that is seen in either frame is at the same places.
bool IsSame(const Points& p, const Points& q) {
  return ((p.array() == q.array()) || (p.array().isNaN() && q.array().isNaN())).all();
}

std::string NameFrames(const std::vector<int>& frames) {
  const std::size_t count = std::min(frames.size(), kNamedFrames);
  const std::vector<int> first(frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(count));
  return fmt::format("{}{}", fmt::join(first, ", "),
                     count < frames.size() ? fmt::format(", ... ({} in all)", frames.size()) : "");
}

}  // namespace

std::vector<int> FramesAfterGaps(const Recording& recording) {
  std::vector<int> gaps;
  for (int first = 0; first + kWindow <= recording.frame_count(); ++first) {
    const Eigen::Array3d squares = SquaredResiduals(recording, first);
    if (squares.tail<2>().minCoeff() < kFarBetter * squares[0]) gaps.push_back(first + kBefore);
  }
  return AreEnough(gaps, recording.frame_count()) ? gaps : std::vector<int>();
}

std::vector<int> RepeatedFrames(const Recording& recording) {
  const auto is_repeated = [&](int t) {
    return recording.points[t].array().isFinite().any() &&
           IsSame(recording.points[t], recording.points[t - 1]);
  };
  std::vector<int> repeated;
  int first = 1;  // of a run of repetitions; what is still for longer, or at an end, is at rest
  for (int t = 1; t < recording.frame_count(); ++t) {
    if (is_repeated(t)) continue;
    if (first > 1 && t - first <= kLongestRepetition) {
      for (int frame = first; frame < t; ++frame) repeated.push_back(frame);
    }
    first = t + 1;
  }
  return repeated.size() >= kFewestOdd ? repeated : std::vector<int>();
}

std::string OddFrameTimes(const Recording& recording) {
  const std::vector<int> repeated = RepeatedFrames(recording);
  if (!repeated.empty()) {
    return fmt::format("frames {} are exactly those before them: were frames recorded twice?",
                       NameFrames(repeated));
  }
  const std::vector<int> gaps = FramesAfterGaps(recording);
  if (gaps.empty()) return "";
  return fmt::format("things move as if frames were missing before frames {}: were some dropped?",
                     NameFrames(gaps));
}

}  // namespace physpring
