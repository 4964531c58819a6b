// SPDX-License-Identifier: Apache-2.0
#include "registration/refine_names.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "tracker/track_recording.h"
#include "trainer/motion/track_error.h"
#include "twin/neighbours.h"

namespace physpring {
namespace {

// By which a prediction may be off, in the particles' spacing, and still tell which is which;
// frames over which distances are averaged; and the fewest that a twin is fitted to.
constexpr double kMostOff = 0.2;
constexpr int kAveraged = 5, kFewestFrames = 12;

// Mean distance of the cloud's points in each frame for fitting to the nearest particle, m; NaN
// where there are none.
std::vector<double> CloudDistances(const Recording& recording,
                                   const std::vector<Points>& position) {
  std::vector<double> distances;
  for (int t = 0; t < recording.train_frames; ++t) {
    const auto frame = static_cast<std::size_t>(t);
    distances.push_back(Mean(DistancesToNearest(position[frame], recording.surface[frame])));
  }
  return distances;
}

// Of those that are known, from `first` to before `end`; NaN if there is none.
double MeanOf(const std::vector<double>& values, int first, int end) {
  double sum = 0, count = 0;
  for (int i = first; i < std::min(end, static_cast<int>(values.size())); ++i) {
    const double value = values[static_cast<std::size_t>(i)];
    if (std::isnan(value)) continue;
    sum += value;
    ++count;
  }
  return sum / count;
}

// How many frames are explained, of a prediction that was fitted to the first `fitted` ones. Usual
// is the noise, and how far apart the particles are: the lower quartile of those frames, since in
// some of them the prediction may be off, which adds to it in squares.
int ExplainedFrames(const std::vector<double>& distances, int fitted, double spacing) {
  const int frames = static_cast<int>(distances.size()), before = kAveraged / 2;
  std::vector<double> averages;
  for (int t = 1; t < frames; ++t) {
    averages.push_back(MeanOf(distances, std::max(1, t - before), t + before + 1));
  }
  std::vector<double> usual;
  for (double average : std::span(averages).first(static_cast<std::size_t>(fitted) - 1)) {
    if (!std::isnan(average)) usual.push_back(average);
  }
  if (usual.empty()) return frames;
  const auto quartile = usual.begin() + static_cast<std::ptrdiff_t>(usual.size() / 4);
  std::nth_element(usual.begin(), quartile, usual.end());
  const double most = std::hypot(*quartile, kMostOff * spacing);
  for (int t = 1; t < frames; ++t) {
    if (averages[static_cast<std::size_t>(t) - 1] > most) return t;
  }
  return frames;
}

}  // namespace

RefinedNames RefineNames(const RegisteredClouds& first, const FitAndPredict& fit) {
  const int all = first.recording.train_frames;
  RefinedNames refined{first};
  Recording named = first.recording;
  double least = std::numeric_limits<double>::infinity();
  for (int fitted = all; refined.fits < kMostNamingRounds && refined.explained < all;) {
    Recording part = named;
    part.train_frames = fitted;
    const std::vector<Points> position = fit(part, refined.fits++);
    const std::vector<double> distances = CloudDistances(named, position);
    refined.explained = ExplainedFrames(distances, fitted, MedianSpacing(position[0]));
    fitted = std::max(refined.explained, std::min(kFewestFrames, all));
    const RegisteredClouds told = TellPoints(named, position);
    named = told.recording;
    if (const double distance = MeanOf(distances, 1, all); distance < least) {
      least = distance;
      refined.registered = told;
    }
  }
  refined.registered.outliers = first.outliers;
  return refined;
}

}  // namespace physpring
