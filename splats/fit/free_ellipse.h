// SPDX-License-Identifier: Apache-2.0
// What a camera sees of a free splat, as projection.h has it, and the way back: derivatives with
// respect to the splat's numbers.
#ifndef PHYSPRING_SPLATS_FIT_FREE_ELLIPSE_H_
#define PHYSPRING_SPLATS_FIT_FREE_ELLIPSE_H_

#include <Eigen/Core>

#include "pictures/camera.h"
#include "splats/fit/free_splats.h"
#include "splats/tile_bins.h"

namespace physpring {

// The numbers of an ellipse that a pixel's colour depends on; also derivatives with respect to
// them. q = (a dx^2 + 2 b dx dy + c dy^2) / 2 at (dx, dy) from (u, v).
struct EllipseNumbers {
  double u = 0, v = 0, a = 0, b = 0, c = 0;
  double opacity = 0;
  Eigen::Vector3d colour = Eigen::Vector3d::Zero();

  void operator+=(const EllipseNumbers& other);
};

struct FreeEllipse : EllipseNumbers {
  double depth = 0, cutoff = 0;
  EllipseBox box;
  int splat = 0;
};

// False: the camera does not see it.
bool ProjectFree(const FreeSplat& splat, const PinholeCamera& camera, FreeEllipse* ellipse);

// Adds to `splat_bar` what `bar`, the derivatives with respect to the ellipse, are with respect to
// the splat's numbers.
void ProjectFreeAdjoint(const FreeSplat& splat, const PinholeCamera& camera,
                        const EllipseNumbers& bar, Eigen::Ref<FreeSplat> splat_bar);

}  // namespace physpring

#endif  // PHYSPRING_SPLATS_FIT_FREE_ELLIPSE_H_
