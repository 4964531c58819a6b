// SPDX-License-Identifier: Apache-2.0
// How well recordings determine an effect's parameters, from the curvature of the misfit: with
// J = d r / d x of the body's numbers and all effects' parameters together,
//   N = J^T J / variance + prior,   C = N^-1.
// The variance is that of the residuals left, so that what the model still gets wrong widens the
// intervals. Neighbouring residuals are alike, so C alone is too narrow: the gradients g of the
// misfit of 20 stretches of time say by how much (the cluster-robust or sandwich covariance: Liang
// and Zeger, Biometrika 73, 1986),
//   C = N^-1 (sum of (g - mean g)(g - mean g)^T + prior) N^-1,
// and the larger of both counts.
#ifndef PHYSPRING_DIAGNOSIS_EFFECT_CERTAINTY_H_
#define PHYSPRING_DIAGNOSIS_EFFECT_CERTAINTY_H_

#include <vector>

#include "diagnosis/fitting.h"

namespace physpring {

struct ValueCertainty {
  double error = 0;  // standard error, in the value's unit
  // The part of what the value does to the motion that other parameters could do as well (its
  // squared multiple correlation): near 1, the recordings cannot tell them apart.
  double shared = 0;
  // The part of its variance that is its prior's: near 1, the recordings say nothing about it.
  double unknown = 0;

  double HalfInterval() const { return 1.96 * error; }  // half a 95 % interval
  bool IsHardlyTold() const { return shared > 0.95; }   // from other parameters
  bool IsUntold() const { return unknown > 0.5; }       // by the recordings
};

// The certainty of the entries of x from `first` on, in the entries' units, from the Jacobian, the
// residuals left, and the prior's precision.
std::vector<ValueCertainty> CertaintyFrom(const Eigen::MatrixXd& jacobian,
                                          const Eigen::VectorXd& residuals,
                                          const Eigen::MatrixXd& precision, int first);

// The certainty of the effects' values, one effect after the other, where a descent is; empty if
// that cannot be evaluated.
std::vector<ValueCertainty> CertaintyOf(const Fitting& fitting, const Descent& fit);

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_EFFECT_CERTAINTY_H_
