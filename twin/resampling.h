// SPDX-License-Identifier: Apache-2.0
// Measurements at times of their own -> frames at a fixed rate. A frame is what was measured at its
// time, or lies on a cubic curve through what was measured before and after:
//   x(t) = h00 x_1 + h10 D m_1 + h01 x_2 + h11 D m_2,   D = t_2 - t_1,
// Hermite's polynomials h, and slopes m of parabolas through three measurements (of a line where
// there are two).
#ifndef PHYSPRING_TWIN_RESAMPLING_H_
#define PHYSPRING_TWIN_RESAMPLING_H_

#include <vector>

#include "twin/points.h"

namespace physpring {

// The times of frames, s: start + t / fps.
struct FrameGrid {
  double start = 0;
  double fps = 0;
  int frames = 0;

  double Time(int frame) const { return start + frame / fps; }
};

// The regular frames that `times` (two or more, s, increasing) come nearest to: the first one is at
// times[0], and the median of the steps is one frame, or `fps` is given (else 0). Steps of about
// several frames are frames that are missing.
FrameGrid GridOf(const std::vector<double>& times, double fps);

// The index of the time that is nearest.
int Nearest(const std::vector<double>& times, double time);

// How far the times are from the frames nearest to them, root mean square, s.
double OffGrid(const std::vector<double>& times, const FrameGrid& grid);

// Columns that were measured at `times` in the frames of the grid. A column is NaN where it was not
// measured at about that time, and the measurements before and after are more than a frame and a
// half apart.
std::vector<Points> ResampleTracks(const std::vector<Points>& measured,
                                   const std::vector<double>& times, const FrameGrid& grid);

// The same of columns that go on moving where nothing is measured for a while: never NaN. Before
// the first time and after the last one they stand still.
std::vector<Points> ResamplePaths(const std::vector<Points>& measured,
                                  const std::vector<double>& times, const FrameGrid& grid);

// The same of clouds, which cannot be averaged: of the nearest time, within half a frame; else NaN.
std::vector<Points> ResampleClouds(const std::vector<Points>& measured,
                                   const std::vector<double>& times, const FrameGrid& grid);

// Numbers that may jump: of the nearest time, within half a frame; else NaN.
std::vector<Eigen::MatrixXd> ResampleNumbers(const std::vector<Eigen::MatrixXd>& measured,
                                             const std::vector<double>& times,
                                             const FrameGrid& grid);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_RESAMPLING_H_
