// SPDX-License-Identifier: Apache-2.0
// Pictures in memory. All have the top row first.
#ifndef PHYSPRING_PICTURES_IMAGE_H_
#define PHYSPRING_PICTURES_IMAGE_H_

#include <vector>

namespace physpring {

// Colours.
struct Image {
  int width = 0, height = 0;
  std::vector<unsigned char> rgb;  // height x width x 3
};

// What each pixel shows.
enum PixelKind : unsigned char {
  kElsewhere = 0,  // not the object
  kHidden = 128,   // something that is in front of the object, or may be: not to be judged
  kObject = 255,
};

struct Mask {
  int width = 0, height = 0;
  std::vector<unsigned char> kind;  // height x width, of PixelKind
};

// How far what is seen is, along the view.
struct DepthImage {
  int width = 0, height = 0;
  std::vector<float> metres;  // height x width; 0: unknown
};

}  // namespace physpring

#endif  // PHYSPRING_PICTURES_IMAGE_H_
