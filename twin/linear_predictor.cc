// SPDX-License-Identifier: Apache-2.0
#include "twin/linear_predictor.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace physpring {
namespace {

constexpr std::array<double, 5> kDelays = {0, 0.1, 0.2, 0.3, 0.4};  // s
constexpr int kMostControllers = 40;
constexpr std::array<int, 7> kComponents = {0, 1, 2, 4, 8, 16, 32};  // numbers that are tried
constexpr double kFirstPart = 0.7;    // of the frames, from which the number is tried
constexpr double kNegligible = 1e-9;  // principal variances below this part of the first are none

// Controllers that are used: all, or some spread over their numbers.
std::vector<int> UsedControllers(int count) {
  const int used = std::min(count, kMostControllers);
  std::vector<int> controllers;
  for (int k = 0; k < used; ++k) controllers.push_back(k * count / used);
  return controllers;
}

Eigen::Vector3d CentreOf(const Recording& recording, int frame) {
  return recording.controllers[frame].rowwise().mean();
}

Eigen::RowVectorXd FeaturesOf(const Recording& recording, int frame) {
  const std::vector<int> used = UsedControllers(recording.controller_count());
  const Eigen::Vector3d centre = CentreOf(recording, frame);
  Eigen::RowVectorXd features(LinearFeatures(recording.controller_count()));
  Eigen::Index at = 0;
  for (double delay : kDelays) {
    const int then = std::max(0, frame - static_cast<int>(std::lround(delay * recording.fps)));
    for (int c : used) {
      features.segment<3>(at) = (recording.controllers[then].col(c) - centre).transpose();
      at += 3;
    }
  }
  return features;
}

// The points of frames [0, count), those not seen by going straight from where they were seen
// before to where they are next: (count) rows of 3 N, relative to the controllers' mean.
Eigen::MatrixXd AnswersOf(const Recording& recording, int count) {
  const int points = recording.point_count();
  Eigen::MatrixXd answers(count, 3 * points);
  for (int i = 0; i < points; ++i) {
    Eigen::Vector3d last = recording.start.col(i);
    int last_seen = 0;
    for (int t = 0; t < count; ++t) {
      const Eigen::Vector3d x = recording.points[t].col(i);
      const bool seen = x.allFinite();
      if (!seen && t + 1 < count) continue;
      const Eigen::Vector3d here = seen ? x : last;
      for (int u = last_seen; u <= t; ++u) {
        const double part = t == last_seen ? 1 : double(u - last_seen) / (t - last_seen);
        answers.block<1, 3>(u, 3 * i) =
            (last + part * (here - last) - CentreOf(recording, u)).transpose();
      }
      last = here;
      last_seen = t;
    }
  }
  return answers;
}

struct Samples {
  Eigen::MatrixXd features, answers;  // a row each
};

Samples Collect(const std::vector<Recording>& recordings, bool first_part) {
  Samples samples;
  for (const Recording& recording : recordings) {
    const int all = recording.train_frames;
    const int count = first_part ? std::max(1, static_cast<int>(kFirstPart * all)) : all;
    const Eigen::MatrixXd answers = AnswersOf(recording, count);
    const Eigen::Index before = samples.features.rows();
    samples.features.conservativeResize(before + count,
                                        LinearFeatures(recording.controller_count()));
    samples.answers.conservativeResize(before + count, answers.cols());
    samples.answers.bottomRows(count) = answers;
    for (int t = 0; t < count; ++t) samples.features.row(before + t) = FeaturesOf(recording, t);
  }
  return samples;
}

// By least squares, with the first `most` principal components of the features.
LinearPredictor Regress(const Samples& samples, int most) {
  LinearPredictor predictor;
  predictor.feature_mean = samples.features.colwise().mean();
  predictor.mean = samples.answers.colwise().mean();
  const Eigen::MatrixXd centred = samples.features.rowwise() - predictor.feature_mean.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> principal(centred.transpose() * centred);
  const Eigen::VectorXd& variances = principal.eigenvalues();  // growing
  const double largest = variances.tail<1>()[0];
  Eigen::Index kept = 0;
  while (kept < std::min<Eigen::Index>(most, variances.size()) &&
         variances[variances.size() - 1 - kept] > kNegligible * largest) {
    ++kept;
  }
  predictor.components = principal.eigenvectors().rightCols(kept);
  const Eigen::MatrixXd scores = centred * predictor.components;
  predictor.weights = (samples.answers.rowwise() - predictor.mean.transpose()).transpose() *
                      scores * variances.tail(kept).cwiseInverse().asDiagonal();
  return predictor;
}

// Of the frames after the first part, m^2.
double MeanSquareOfLaterFrames(const LinearPredictor& predictor,
                               const std::vector<Recording>& recordings) {
  double sum = 0, count = 0;
  for (const Recording& recording : recordings) {
    const std::vector<Points> predicted = PredictLinearly(predictor, recording);
    for (int t = static_cast<int>(kFirstPart * recording.train_frames); t < recording.train_frames;
         ++t) {
      for (double d : (recording.points[t] - predicted[t]).reshaped()) {
        if (!std::isfinite(d)) continue;
        sum += d * d;
        ++count;
      }
    }
  }
  return sum / std::max(1.0, count);
}

}  // namespace

int LinearFeatures(int controllers) {
  return 3 * std::min(controllers, kMostControllers) * static_cast<int>(kDelays.size());
}

LinearPredictor FitLinearPredictor(const std::vector<Recording>& recordings) {
  if (recordings.empty() || recordings[0].controller_count() == 0) return {};
  const Samples first = Collect(recordings, true);
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int count : kComponents) {
    const double square = MeanSquareOfLaterFrames(Regress(first, count), recordings);
    if (square >= least) continue;
    least = square;
    best = count;
  }
  return Regress(Collect(recordings, false), best);
}

std::vector<Points> PredictLinearly(const LinearPredictor& predictor, const Recording& recording) {
  std::vector<Points> frames;
  for (int t = 0; t < recording.frame_count(); ++t) {
    const Eigen::VectorXd scores = predictor.components.transpose() *
                                   (FeaturesOf(recording, t).transpose() - predictor.feature_mean);
    const Eigen::VectorXd x = predictor.mean + predictor.weights * scores;
    frames.emplace_back(x.reshaped(3, recording.point_count()).colwise() + CentreOf(recording, t));
  }
  return frames;
}

}  // namespace physpring
