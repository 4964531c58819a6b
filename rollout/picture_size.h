// SPDX-License-Identifier: Apache-2.0
// Pictures in the size that a policy was trained with.
#ifndef PHYSPRING_ROLLOUT_PICTURE_SIZE_H_
#define PHYSPRING_ROLLOUT_PICTURE_SIZE_H_

#include "pictures/image.h"

namespace physpring {

// The picture in `width` x `height` pixels, undistorted, with black bars where its sides have
// another ratio. The bytes are those of resize_with_pad of openpi-client, which takes Pillow's
// bilinear filter: a triangle, as wide as the step where the picture shrinks, first along rows,
// then along columns, in whole numbers.
Image ResizeWithPad(const Image& image, int width, int height);

// Left and right changed.
Image Mirror(const Image& image);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_PICTURE_SIZE_H_
