// SPDX-License-Identifier: Apache-2.0
// .png files of the three kinds of pictures.
#ifndef PHYSPRING_PICTURES_PNG_FILE_H_
#define PHYSPRING_PICTURES_PNG_FILE_H_

#include <string>

#include "pictures/image.h"

namespace physpring {

// All throw Error, one line that begins with the path: for a file that is missing, damaged, or of
// another size than `width` x `height`, before anything is allocated for it.

// Colours, 8 bits a channel. What the file has as grey, with a palette or transparent is read as
// colours on black.
Image ReadColours(const std::string& path, int width, int height);

// 8 bits of grey, each a PixelKind.
Mask ReadMask(const std::string& path, int width, int height);

// 16 bits of grey, in units of `unit` m.
DepthImage ReadDepth(const std::string& path, int width, int height, double unit);

// The file's bytes.
std::string PngBytes(const Image& image);

void WritePng(const Image& image, const std::string& path);
void WritePng(const Mask& mask, const std::string& path);
// What is farther than 65535 units is unknown.
void WritePng(const DepthImage& depth, double unit, const std::string& path);

}  // namespace physpring

#endif  // PHYSPRING_PICTURES_PNG_FILE_H_
