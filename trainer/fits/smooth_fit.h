// SPDX-License-Identifier: Apache-2.0
// The fit of a smooth body (bodies/smooth_body.h): Levenberg-Marquardt on its few numbers. A rough
// fit is quick: it finds a valley, under an observer whose gain falls (observer.h). The fit to the
// end goes down to the bottom of it. That takes long in a wrong one.
#ifndef PHYSPRING_TRAINER_FITS_SMOOTH_FIT_H_
#define PHYSPRING_TRAINER_FITS_SMOOTH_FIT_H_

#include <optional>
#include <vector>

#include "trainer/bodies/chosen_body.h"
#include "trainer/bodies/smooth_body.h"
#include "trainer/journal/work.h"

namespace physpring {

// A smooth body and its numbers.
struct SmoothlyFitted {
  SmoothBody body;
  Eigen::VectorXd x;

  SpringMassSystem System() const { return body.Apply(x); }
};

// What a fit leaves, and how that depends on its numbers.
struct LinearisedFit {
  Eigen::VectorXd residuals;  // m
  Eigen::MatrixXd slope;      // residuals x numbers
};

// The body that fits start from: its contact with the ground as chosen, all else as soft as the
// choice began, and its loss time `lossier` times as long.
SmoothlyFitted SoftSmoothBody(const ChosenBody& chosen, const std::vector<Episode>& episodes,
                              const SmoothBody::Options& body, double lossier = 1);

// The gains of an observer, one after the other: those that show a soft body the way, and those
// under which one that is far off is led back to all of the motions.
inline std::vector<double> GuidingGains() { return {0.5, 0.2, 0.1, 0}; }
inline std::vector<double> LeadingGains() { return {0.2, 0.1}; }

// Numbers that about fit the episodes, found under an observer of these gains, one after the other.
SmoothlyFitted FitRoughly(const SmoothlyFitted& start, const std::vector<double>& gains,
                          const ChosenBody& chosen, const std::vector<Episode>& episodes,
                          const TrainOptions& options, const Work& work);

// The numbers that fit the episodes best by free motions.
SmoothlyFitted FitToTheEnd(const SmoothlyFitted& start, const ChosenBody& chosen,
                           const std::vector<Episode>& episodes, const TrainOptions& options,
                           const Work& work);

// Of free motions; nothing where the fit cannot be followed.
std::optional<LinearisedFit> LineariseFit(const SmoothlyFitted& fit, const ChosenBody& chosen,
                                          const std::vector<Episode>& episodes,
                                          const TrainOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_SMOOTH_FIT_H_
