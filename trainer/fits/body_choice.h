// SPDX-License-Identifier: Apache-2.0
// The choice of a body (bodies/body.h) and of the start values of its common factors, on held-back
// frames. In three rounds, under an observer whose gain falls (observer.h):
//   far      each candidate's factors are fitted with the two highest gains, from the best of a few
//            start stiffnesses and frictions; three with and three without the controllers'
//            velocity go on
//   near     those are fitted with lower gains; the best with and without velocity go on
//   springs  those are fitted a few steps further, spring by spring, with the same low gain, and
//            judged by a free motion as well; a chain that bends (bodies/bending_chain.h) by its
//            factors
#ifndef PHYSPRING_TRAINER_FITS_BODY_CHOICE_H_
#define PHYSPRING_TRAINER_FITS_BODY_CHOICE_H_

#include "trainer/bodies/chosen_body.h"
#include "trainer/data/fit_data.h"
#include "trainer/journal/work.h"

namespace physpring {

struct BodyChoice {
  ChosenBody model;
  // The springs' own values (factors.h, SpringFactors) of that model, as the last round fitted
  // them; empty where there was none.
  Eigen::VectorXd springs;
};

// Computes in single precision: for a choice that is enough. Throws Error where the recordings give
// no body, and if the motion diverges with the start values of every candidate.
BodyChoice ChooseBody(const FitData& data, const TrainOptions& asked, const Work& work);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_BODY_CHOICE_H_
