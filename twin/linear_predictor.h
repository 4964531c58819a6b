// SPDX-License-Identifier: Apache-2.0
// A linear regression of the measured points on what the controllers do now and did up to 0.4 s
// ago. It knows no physics. A twin that predicts worse than it is of little use, so a twin carries
// the one of the recordings that it was trained on, and eval shows both.
//
// With m the mean of the controllers now, features are the controllers c(t - d) - m for delays d of
// 0, 0.1, ..., 0.4 s (before frame 0 they stand still), and the answer is x_i(t) - m for each
// point. Features are reduced to their first principal components; how many is chosen by the last
// 30 % of the frames for fitting. So it goes along with the controllers wherever they are.
#ifndef PHYSPRING_TWIN_LINEAR_PREDICTOR_H_
#define PHYSPRING_TWIN_LINEAR_PREDICTOR_H_

#include <Eigen/Core>
#include <vector>

#include "twin/recording.h"

namespace physpring {

struct LinearPredictor {
  Eigen::VectorXd feature_mean;  // (features), m
  Eigen::MatrixXd components;    // features x components
  Eigen::MatrixXd weights;       // 3 points x components
  Eigen::VectorXd mean;          // (3 points), m: the answer where features are at their means

  bool empty() const { return mean.size() == 0; }
};

// Numbers of features for so many controllers. Of very many controllers some are used.
int LinearFeatures(int controllers);

// Learned from the frames for fitting of recordings of one object. Empty without controllers.
LinearPredictor FitLinearPredictor(const std::vector<Recording>& recordings);

// The points in every frame: T frames of 3 x N. The recording has as many points and controllers as
// those that it was learned from.
std::vector<Points> PredictLinearly(const LinearPredictor& predictor, const Recording& recording);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_LINEAR_PREDICTOR_H_
