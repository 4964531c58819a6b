// SPDX-License-Identifier: Apache-2.0
// How far a prediction is from a recording (PhysTwin's metrics), frame by frame.
//   CD     mean over the measured points g of min over the predicted nodes y of |g - y|: one way,
//          from measured to predicted. In the L1 norm (|x| + |y| + |z|), as published, or
//          Euclidean; the nearest node is the nearest in the same norm.
//   track  mean over the measured points of |x_i - g_i|, Euclidean, x_i the node that stands for
//   g_i.
// Only points that are seen count. A frame in which none is seen has no data: it is left out of
// means and counted, never taken as an error of 0.
#ifndef PHYSPRING_TWIN_METRICS_H_
#define PHYSPRING_TWIN_METRICS_H_

#include <optional>
#include <vector>

#include "twin/points.h"
#include "twin/recording.h"

namespace physpring {

enum class Norm { kL1, kEuclidean };

// CD of one frame, m; NaN if no column of `measured` (3 x points, NaN = not seen) is seen.
double ChamferDistance(const Points& measured, const Points& predicted, Norm norm);

// Track error of one frame, m: measured point i against column nodes[i] of `predicted`; points with
// node -1 do not count. NaN if no point counts.
double TrackError(const Points& measured, const Points& predicted, const std::vector<int>& nodes);

// The node that stands for each tracked point (`track` of the recording, else `points`), given the
// nodes' positions in frame 0 (3 x nodes): the nearest to where the point then was. Key points that
// are not seen in frame 0 have none (-1).
std::vector<int> NearestNodesAtStart(const Recording& recording, const Points& nodes);

// The same when the nodes are the particles of level 0: points are particles, by index.
std::vector<int> ParticlesOfTrack(const Recording& recording);

// Errors of all frames, m; NaN for a frame without data.
struct FrameErrors {
  std::vector<double> cd, cd_euclidean, track;
};

// `predicted`: T frames of 3 x nodes. `surface`: the nodes that CD may choose from; CD is of
// the recording's `surface` where it has one, else of its points.
FrameErrors ComputeFrameErrors(const Recording& recording, const std::vector<Points>& predicted,
                               const std::vector<int>& surface, const std::vector<int>& track);

// The same of the particles of level 0: T frames of 3 x (points + interior).
FrameErrors ComputeParticleErrors(const Recording& recording, const std::vector<Points>& particles);

struct MeanError {
  std::optional<double> value;  // m; none if no frame has data
  int frames = 0;               // that have data
  int frames_without_data = 0;
};

// Over frames [first, last).
MeanError MeanOverFrames(const std::vector<double>& errors, int first, int last);

// The measure published for the cable recordings of Chen et al. (CoRL 2024): the sum over frames
// 1 .. T - 1 of the mean |dx| over coordinates and all markers, divided by T + 1. Controllers are
// markers with error 0. (Their recordings have 500 frames, of which frame 0 here is the second.)
// `predicted`: T frames of at least the N points.
std::optional<double> PublishedL1(const Recording& recording, const std::vector<Points>& predicted);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_METRICS_H_
