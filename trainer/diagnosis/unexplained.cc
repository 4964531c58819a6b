// SPDX-License-Identifier: Apache-2.0
#include "trainer/diagnosis/unexplained.h"

#include <cmath>

namespace physpring {

Unexplained FindUnexplained(const std::vector<SplitRecording>& recordings, const EffectFit& fit,
                            double floor) {
  Unexplained unexplained;
  unexplained.track = fit.track.held - floor;
  const Recording& recording = *recordings[0].recording;
  const std::vector<Points>& predicted = fit.predicted[0];
  const int points = recording.point_count();
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(points);
  Points mean = Points::Zero(3, points);
  std::vector<double> of_frame(predicted.size(), 0);
  for (std::size_t frame = 1; frame < predicted.size(); ++frame) {
    for (int i = 0; i < points; ++i) {
      const Eigen::Vector3d r = recording.points[frame].col(i) - predicted[frame].col(i);
      if (std::isnan(r[0])) continue;
      sum[i] += r.squaredNorm();
      mean.col(i) += r;
      of_frame[frame] += r.squaredNorm();
    }
  }
  Eigen::Index worst = 0;
  sum.maxCoeff(&worst);
  unexplained.point = static_cast<int>(worst);
  unexplained.position = recording.start.col(worst);
  unexplained.direction = mean.col(worst).normalized();
  // the shortest run of frames that holds half of the squared error
  double total = 0;
  for (double e : of_frame) total += e;
  std::size_t best_length = of_frame.size(), first = 0;
  double window = 0;
  for (std::size_t begin = 0, end = 0; end < of_frame.size(); ++end) {
    window += of_frame[end];
    while (window - of_frame[begin] >= total / 2 && begin < end) window -= of_frame[begin++];
    if (window >= total / 2 && end - begin < best_length) {
      best_length = end - begin;
      first = begin;
    }
  }
  unexplained.first_time = static_cast<double>(first) / recording.fps;
  unexplained.last_time = static_cast<double>(first + best_length) / recording.fps;
  return unexplained;
}

}  // namespace physpring
