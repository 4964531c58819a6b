// SPDX-License-Identifier: Apache-2.0
// Splats on the surface of an object, as cameras with depth saw it: where a fit begins.
#ifndef PHYSPRING_SPLATS_FIT_SURFACE_START_H_
#define PHYSPRING_SPLATS_FIT_SURFACE_START_H_

#include <vector>

#include "pictures/picture_folder.h"
#include "splats/fit/free_splats.h"

namespace physpring {

struct SurfaceStart {
  FreeSplats splats;
  double spacing = 0;  // m, of the splats
};

// About `count` flat splats, one in each cube of a grid that the surface passes through, of the
// mean place, normal and colour there, as `cameras` saw them; fewer where the pictures have not so
// many pixels of the object. Throws Error, one line that begins with the folder: no depth, or an
// object that is not seen.
SurfaceStart StartOnSurface(const PictureFolder& pictures, const std::vector<int>& cameras,
                            int frame, int count);

}  // namespace physpring

#endif  // PHYSPRING_SPLATS_FIT_SURFACE_START_H_
