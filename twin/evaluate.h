// SPDX-License-Identifier: Apache-2.0
// A twin judged on one recording: every level predicts it, and each frame is compared with what was
// measured. Next to it predictions that need no twin (baselines.h).
//
// "Direct" errors compare the nodes of a level themselves, as published: CD from the nodes that
// stand for a measured point, track from the node nearest in frame 0 (at level 0: by index).
// "Lifted" errors compare the particles of level 0 that the nodes carry along (lift.h).
#ifndef PHYSPRING_TWIN_EVALUATE_H_
#define PHYSPRING_TWIN_EVALUATE_H_

#include <optional>
#include <string>
#include <vector>

#include "twin/baselines.h"
#include "twin/metrics.h"
#include "twin/predict.h"
#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

struct LevelResult {
  int level = 0;
  int nodes = 0;
  int springs = 0;
  int substeps = 0;              // a frame
  double frames_per_second = 0;  // simulated, by one thread; reading and comparing not counted
  FrameErrors direct, lifted;    // the errors of all frames
  std::optional<double> published_l1;  // m, of the lifted points
  std::vector<Points> positions;       // T frames of 3 x nodes, m
  std::vector<Points> points;          // T frames of 3 x N, m: the measured points as predicted
};

struct BaselineResult {
  std::string name, description;  // Baseline
  FrameErrors errors;
  std::optional<double> published_l1;  // m
  std::vector<Points> positions;       // T frames of 3 x (N+M), m
};

struct RecordingResult {
  bool trained_on = false;  // by hash
  // Frames [1, first_predicted) were fitted, [first_predicted, T) are predicted. 1 if not trained
  // on.
  int first_predicted = 1;
  std::vector<LevelResult> levels;
  std::vector<BaselineResult> baselines;  // the first one is motionless
};

// `others`: predictions of other methods, which are judged as the baselines are. Throws Error as
// Predict does.
RecordingResult Evaluate(const Twin& twin, const Recording& recording,
                         const PredictOptions& options, const std::vector<Baseline>& others = {});

// Means over a range of frames.
struct ErrorMeans {
  MeanError cd, cd_euclidean, track;
};
ErrorMeans MeansOverFrames(const FrameErrors& errors, int first, int last);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_EVALUATE_H_
