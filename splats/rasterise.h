// SPDX-License-Identifier: Apache-2.0
// A picture of splats, on a CPU: at each pixel, from the nearest ellipse to the farthest,
//   alpha = min(0.99, opacity exp(-q)),  left out below 1 / 255
//   colour += T alpha c,   T *= 1 - alpha,   until T < 1e-4; then colour += T background
// (Kerbl et al. 2023, equation 3). It works through tiles of 16 x 16 pixels, on threads.
#ifndef PHYSPRING_SPLATS_RASTERISE_H_
#define PHYSPRING_SPLATS_RASTERISE_H_

#include <vector>

#include "pictures/camera.h"
#include "splats/splats.h"

namespace physpring {

// What is behind and between the splats, as another renderer has drawn it.
struct Backdrop {
  std::vector<float> rgb;    // height x width x 3, 0 to 1; empty: black
  std::vector<float> depth;  // height x width, m along the view; empty: infinitely far
};

struct SplatPicture {
  int width = 0, height = 0;
  std::vector<float> rgb;       // height x width x 3, the top row first; may exceed 1
  std::vector<float> coverage;  // height x width, 1 - T: 0 where there is no splat, to 1
};

// Splats that are farther than the backdrop's depth at a pixel are behind it there. The same bits
// for any number of threads.
SplatPicture Rasterise(SplatGroups groups, const PinholeCamera& camera, const Backdrop& backdrop,
                       int threads);
SplatPicture Rasterise(const PlacedSplats& splats, const PinholeCamera& camera,
                       const Backdrop& backdrop, int threads);

}  // namespace physpring

#endif  // PHYSPRING_SPLATS_RASTERISE_H_
