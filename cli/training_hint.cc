// SPDX-License-Identifier: Apache-2.0
#include "cli/training_hint.h"

#include <fmt/format.h>

#include "cli/progress.h"

namespace physpring {

std::string HintIfLong(const TrainOptions& options, double seconds, double seconds_left) {
  constexpr double kPaceIsKnown = 30, kLong = 30 * 60;  // s
  if (seconds < kPaceIsKnown || seconds_left < kLong) return "";
  const bool full = options.method == TrainOptions::Method::kFull;
  std::string shorter;
  if (full && options.neighbours.size() != 1) shorter += "--neighbours 20, ";
  if (full && !options.controller_velocity) shorter += "--controller-velocity off, ";
  if (full && !options.cone) shorter += "--cone elliptic, ";
  if (!full && options.epochs == 0) shorter += "a small --epochs, ";
  if (!options.single_precision) shorter += "--precision float, ";
  if (options.levels > 1) shorter += "fewer --levels, ";
  return fmt::format(
      "note: {} left; each of these makes it shorter: {}fewer points, fewer frames (Ctrl-C leaves "
      "a checkpoint)",
      FormatDuration(seconds_left), shorter);
}

}  // namespace physpring
