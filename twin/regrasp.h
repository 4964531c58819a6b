// SPDX-License-Identifier: Apache-2.0
// A twin that is held elsewhere than in the recordings that it was trained on.
#ifndef PHYSPRING_TWIN_REGRASP_H_
#define PHYSPRING_TWIN_REGRASP_H_

#include <vector>

#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

// A controller that holds another place of the body.
struct MovedGrasp {
  int controller;
  Eigen::Vector3d place;  // on the body as `reference` has it, m
  double distance;        // from the place that the reference holds, m
};

// The controllers of `recording` that hold other particles than those of `reference` do, 3 x
// (particles + controllers), m, as many as in the recording: their distances from the three that
// are nearest in the reference differ by more than half a spacing, on the average. A place is
// carried from frame 0 to the reference with the particles around it.
std::vector<MovedGrasp> FindMovedGrasps(const Points& reference, const Recording& recording);

// Lets the twin's controllers hold there: in each level as many of the nearest nodes as before,
// with the springs that it had, the stiffness of the nearest one for the nearest node and so on.
// Their rest lengths are the distances in the reference configuration.
void MoveGrasps(const std::vector<MovedGrasp>& moved, const Recording& recording, Twin* twin);

// The twin with its grasps where those of the recording are, if it was not trained on it; a note of
// the recording says which moved. Both are of one object (ExpectSameObject).
Twin HeldAsIn(Recording* recording, Twin twin);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_REGRASP_H_
