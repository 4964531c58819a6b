// SPDX-License-Identifier: Apache-2.0
// A picture of splats in bytes.
#ifndef PHYSPRING_SPLATS_PICTURE_BYTES_H_
#define PHYSPRING_SPLATS_PICTURE_BYTES_H_

#include <algorithm>
#include <cmath>

#include "pictures/image.h"
#include "splats/rasterise.h"

namespace physpring {

// Rounded; what is below 0 or above 1 is black or full.
inline Image BytesOf(const SplatPicture& picture) {
  Image image{picture.width, picture.height, std::vector<unsigned char>(picture.rgb.size())};
  std::transform(picture.rgb.begin(), picture.rgb.end(), image.rgb.begin(), [](float colour) {
    return static_cast<unsigned char>(std::lround(255 * std::clamp(colour, 0.0F, 1.0F)));
  });
  return image;
}

}  // namespace physpring

#endif  // PHYSPRING_SPLATS_PICTURE_BYTES_H_
