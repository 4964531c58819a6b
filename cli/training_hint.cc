// SPDX-License-Identifier: Apache-2.0
#include "cli/training_hint.h"

#include <fmt/format.h>

#include "cli/progress.h"

namespace physpring {

std::string HintIfLong(const TrainOptions& options, double seconds, double seconds_left) {
  constexpr double kPaceIsKnown = 30, kLong = 30 * 60;  // s
  if (seconds < kPaceIsKnown || seconds_left < kLong) return "";
  const bool two_stage = options.method == TrainOptions::Method::kTwoStage;
  std::string shorter;
  if (!two_stage && options.neighbours.size() != 1) shorter += "--neighbours 20, ";
  if (!two_stage && !options.controller_velocity) shorter += "--controller-velocity off, ";
  if (!two_stage && !options.cone) shorter += "--cone elliptic, ";
  if (two_stage && options.epochs == 0) shorter += "a small --epochs, ";
  if (!options.single_precision) shorter += "--precision float, ";
  if (options.levels > 1) shorter += "fewer --levels, ";
  return fmt::format(
      "note: {} left; each of these makes it shorter: {}fewer points, fewer frames (Ctrl-C leaves "
      "a checkpoint)",
      FormatDuration(seconds_left), shorter);
}

}  // namespace physpring
