// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/split_recording.h"

#include <algorithm>
#include <cmath>
#include <ranges>

namespace physpring {
namespace {

using Use = SplitRecording::Use;

constexpr double kHeldBlock = 0.3;  // s
// The body rests where it is nearer to its end than this part of the greatest distance, noise
// aside; so many seconds of rest are kept.
constexpr double kRest = 0.02, kKeptOfRest = 0.5;
constexpr int kEnd = 5;  // the mean of so many frames is the end

// The mean square of the distance from the end, of those columns that are seen, in each frame.
std::vector<double> SquaresFromEnd(const std::vector<Points>& frames) {
  const Eigen::Index count = frames[0].cols();
  Points end = Points::Zero(3, count);
  Eigen::ArrayXi seen = Eigen::ArrayXi::Zero(count);
  for (const Points& frame : std::views::reverse(frames)) {
    for (Eigen::Index i = 0; i < count; ++i) {
      if (seen[i] == kEnd || frame.col(i).hasNaN()) continue;
      end.col(i) += frame.col(i);
      ++seen[i];
    }
  }
  std::vector<double> squares;
  for (const Points& frame : frames) {
    double sum = 0;
    int columns = 0;
    for (Eigen::Index i = 0; i < count; ++i) {
      if (frame.col(i).hasNaN()) continue;
      sum += (frame.col(i) - end.col(i) / seen[i]).squaredNorm();
      ++columns;
    }
    squares.push_back(columns > 0 ? sum / columns : 0);
  }
  return squares;
}

// The frame from which on everything rests.
std::size_t FirstAtRest(const std::vector<double>& squares, double noise) {
  const double most = *std::max_element(squares.begin(), squares.end());
  const double limit = kRest * kRest * most + 3 * (2 * noise) * (2 * noise);
  const auto moving =
      std::find_if(squares.rbegin(), squares.rend(), [&](double square) { return square > limit; });
  return static_cast<std::size_t>(squares.rend() - moving);
}

}  // namespace

SplitRecording HoldOutFrames(const Recording& recording) {
  SplitRecording split = UseAll(recording, Use::kFit);
  // a short recording still has one block of the four
  const int most = std::max(1, recording.frame_count() / 4);
  const int usual = std::max(1, static_cast<int>(kHeldBlock * recording.fps));
  const auto block = static_cast<std::size_t>(std::min(usual, most));
  const auto future = static_cast<std::size_t>(recording.train_frames);
  const bool has_future = future < split.use.size();
  for (std::size_t frame = 1; frame < split.use.size(); ++frame) {
    const bool held = has_future ? frame >= future : frame / block % 4 == 3;
    if (held) split.use[frame] = Use::kHeld;
  }
  return split;
}

int LeaveOutRest(double noise, SplitRecording* split) {
  const Recording& recording = *split->recording;
  std::size_t rest = FirstAtRest(SquaresFromEnd(recording.points), noise);
  if (recording.controller_count() > 0) {
    rest = std::max(rest, FirstAtRest(SquaresFromEnd(recording.controllers), 0));
  }
  rest += static_cast<std::size_t>(std::ceil(kKeptOfRest * recording.fps));
  const auto held = std::count(split->use.begin(), split->use.end(), Use::kHeld);
  int taken = 0, held_before = 0;
  for (std::size_t frame = 0; frame < split->use.size(); ++frame) {
    Use& use = split->use[frame];
    const bool half_of_held = 2 * held_before >= held;
    held_before += use == Use::kHeld ? 1 : 0;
    if (frame < rest || !half_of_held || use == Use::kNone) continue;
    use = Use::kNone;
    ++taken;
  }
  return taken;
}

SplitRecording FitHeldOut(SplitRecording split) {
  std::replace(split.use.begin(), split.use.end(), Use::kHeld, Use::kFit);
  return split;
}

SplitRecording DropHeldOut(SplitRecording split) {
  std::replace(split.use.begin(), split.use.end(), Use::kHeld, Use::kNone);
  return split;
}

}  // namespace physpring
