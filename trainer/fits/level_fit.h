// SPDX-License-Identifier: Apache-2.0
// The fit of the parameters of a coarse level to the measured points, through the lift. Topology,
// masses and first values of the level are a Galerkin projection. The fit has three parts:
//   common   the same few factors for all springs (parameters.h), by Levenberg-Marquardt, under an
//            observer whose gain falls to 0 (observer.h)
//   network  corrections by the graph network, and those of the contact
//            (network/corrections_fit.h)
//   springs  every spring's own stiffness, dashpot and rest length, by Gauss-Newton
// If there are several projections, the one whose common factors follow the recordings best is
// taken.
#ifndef PHYSPRING_TRAINER_FITS_LEVEL_FIT_H_
#define PHYSPRING_TRAINER_FITS_LEVEL_FIT_H_

#include <vector>

#include "trainer/data/fit_data.h"
#include "trainer/data/train_options.h"
#include "trainer/journal/work.h"
#include "trainer/network/graph_network.h"
#include "twin/twin.h"

namespace physpring {

struct FittedLevel {
  TwinLevel level;
  Eigen::VectorXd weights;  // the network's weights after the fit
};

// Fits the last level of each of `twins`, which are the same but for that one, with a network that
// has these weights, and returns the best of them.
FittedLevel FitLevel(const FitData& data, const TrainOptions& options,
                     const std::vector<Twin>& twins, const GraphNetwork& network,
                     const Eigen::VectorXd& weights, const Work& work);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_LEVEL_FIT_H_
