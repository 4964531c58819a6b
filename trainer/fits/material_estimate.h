// SPDX-License-Identifier: Apache-2.0
// What a fitted spring net is made of, and how well the recordings tell it.
#ifndef PHYSPRING_TRAINER_FITS_MATERIAL_ESTIMATE_H_
#define PHYSPRING_TRAINER_FITS_MATERIAL_ESTIMATE_H_

#include "twin/material.h"
#include "twin/posterior.h"
#include "twin/spring_mass_system.h"

namespace physpring {

// The material of a system, with intervals that hold 90 % of this posterior, whose logarithms are
// taken as linear.
Material EstimateMaterial(const SpringMassSystem& system, const Posterior& posterior);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_MATERIAL_ESTIMATE_H_
