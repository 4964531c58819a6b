// SPDX-License-Identifier: Apache-2.0
// A loss of the pixels of a picture of splats, and its derivatives with respect to all numbers of
// the splats: the formula of rasterise.h, on black, in double precision, forwards and back.
#ifndef PHYSPRING_SPLATS_FIT_PICTURE_LOSS_H_
#define PHYSPRING_SPLATS_FIT_PICTURE_LOSS_H_

#include <Eigen/Core>
#include <functional>

#include "pictures/camera.h"
#include "splats/fit/free_splats.h"

namespace physpring {

// A pixel of the picture; also derivatives with respect to it.
struct Pixel {
  Eigen::Vector3d colour = Eigen::Vector3d::Zero();  // red, green, blue
  double coverage = 0;                               // 0 where there is no splat, to 1
};

// The loss of the pixel at `place` (row by row) that looks so, and its derivatives.
using PixelLoss = std::function<double(std::size_t place, const Pixel& pixel, Pixel* bar)>;

// The sum of `loss` over all pixels; adds its derivatives to `gradient`. The same bits for any
// number of threads, which call `loss` at the same time.
double AddPictureLoss(const FreeSplats& splats, const PinholeCamera& camera, const PixelLoss& loss,
                      int threads, FreeSplats* gradient);

}  // namespace physpring

#endif  // PHYSPRING_SPLATS_FIT_PICTURE_LOSS_H_
