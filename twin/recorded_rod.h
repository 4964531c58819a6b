// SPDX-License-Identifier: Apache-2.0
// The rod of a recording. Its file has arc lengths (`order`), by which all columns follow each
// other, or edges (`rod`). A controller that does not hold all the time is no part of the rod,
// which would else be bent by a hand that is gone. Neither joins two objects.
#ifndef PHYSPRING_TWIN_RECORDED_ROD_H_
#define PHYSPRING_TWIN_RECORDED_ROD_H_

#include "twin/npz_fields.h"
#include "twin/recording.h"

namespace physpring {

// The array `rod`, (edges, 2), of a body of so many columns. Throws Error if an edge names another
// column, or one twice.
RodEdges ReadRodEdges(NpzFields& fields, Eigen::Index columns);
NpzArray StoreRodEdges(const RodEdges& edges);

// Reads `order` or `rod`; `rest` and the declared objects must be known. Throws Error if both are
// there, if the edges leave a particle out, fall into parts and no objects are declared, or join
// declared objects.
void ReadRod(NpzFields& fields, Recording* recording);

// The arc length at a place of frame 0, from the particles that are nearest to it, m.
double ArcLengthAt(const Recording& recording, const Eigen::Vector3d& place);

// Takes out the controllers that do not hold in all frames.
void KeepHoldingControllers(const Recording& recording, Rod* rod);

// Cuts the rod between objects, where there are several.
void CutRodBetweenObjects(Recording* recording);

// Stores what is read as the same rod.
void StoreRod(const Recording& recording, Npz* arrays);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_RECORDED_ROD_H_
