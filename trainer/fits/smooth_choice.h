// SPDX-License-Identifier: Apache-2.0
// Which smooth body (bodies/smooth_body.h) fits the recordings: fits of it end in side valleys, and
// which one depends on how many sub-steps it may take and on what it tells apart. Some are roughly
// fitted to the first part of the motions. The best one goes on to the end.
#ifndef PHYSPRING_TRAINER_FITS_SMOOTH_CHOICE_H_
#define PHYSPRING_TRAINER_FITS_SMOOTH_CHOICE_H_

#include <vector>

#include "trainer/bodies/chosen_body.h"
#include "trainer/fits/smooth_fit.h"
#include "trainer/journal/work.h"

namespace physpring {

struct SmoothlyChosen {
  SmoothlyFitted fit;
  ChosenBody model;    // as given, but for the cone and the controllers' velocity
  double correlation;  // of what the fit leaves (residual_correlation.h)
  int substeps;        // a frame, that it was fitted with; 0: as many as are stable
};

// The first smooth body that surely leaves no more than noise of the episodes, or else the best
// one. Where the options leave open which cone friction has, the first body that leaves more than
// noise in the first part is fitted anew with the other one. Where they leave open whether dashpots
// feel the controllers' velocity, the first body that leaves more than noise there, and wants no
// more sub-steps, is fitted with the other treatment, too; a lost body asks again, with directions
// apart. The better one of both goes on. With `few`, for many particles, bodies do not tell hands
// or directions apart.
SmoothlyChosen ChooseSmoothBody(const ChosenBody& model, const std::vector<Episode>& episodes,
                                const TrainOptions& options, bool few, const Work& work);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_SMOOTH_CHOICE_H_
