// SPDX-License-Identifier: Apache-2.0
// Splats of one's own: fitted to what cameras saw of an object in one frame.
#ifndef PHYSPRING_SPLATS_FIT_SPLAT_FIT_H_
#define PHYSPRING_SPLATS_FIT_SPLAT_FIT_H_

#include <functional>
#include <optional>
#include <vector>

#include "pictures/image_errors.h"
#include "pictures/picture_folder.h"
#include "splats/splats.h"

namespace physpring {

struct SplatFitOptions {
  int frame = 0;
  std::vector<int> cameras = {};  // numbers in the folder, that are fitted to; empty: all
  int count = 20000;              // about so many splats
  int iterations = 300;           // of Adam
  int threads = 1;
  std::function<void(int iteration, double loss)> progress = {};
};

struct SplatFit {
  Splats splats;                    // of one colour from all sides
  double spacing = 0;               // m, of the splats at the start
  double first_loss = 0, loss = 0;  // before and after the fit
  // Of that frame, by camera of the folder; none: it does not see the object.
  std::vector<std::optional<ImageErrors>> errors;
};

// Minimises, over all pixels of those cameras that are not hidden,
//   sum |colour - recorded|^2 + (coverage - mask)^2,   a pixel of the object counting as 1 / their
// number; the object is alone, on black. Splats begin on the surface (surface_start.h). All their
// numbers are free; their deviations are kept between 0.1 and 1.5 spacings, so that what they look
// like when they move apart is known. The same bits for any number of threads. Throws Error for
// pictures that are missing or damaged, Stopped where that is asked for.
SplatFit FitSplats(const PictureFolder& pictures, const SplatFitOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_SPLATS_FIT_SPLAT_FIT_H_
