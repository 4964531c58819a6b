// SPDX-License-Identifier: Apache-2.0
// Splats in a .ply file, as the reference implementation of Gaussian splatting writes them, and
// most programs since: binary, little endian, one element `vertex` of floats
//   x y z, f_dc_0 to 2, f_rest_0 to 3 (K - 1) - 1, opacity, scale_0 to 2, rot_0 to 3
// with K = 1, 4, 9 or 16 harmonics; f_rest has those of red first, then green, then blue. Other
// properties, as nx ny nz, are passed over.
#ifndef PHYSPRING_SPLATS_SPLAT_FILE_H_
#define PHYSPRING_SPLATS_SPLAT_FILE_H_

#include <string>

#include "splats/splats.h"

namespace physpring {

// Throws Error, one line that begins with the path, for a file that is cut short, of another kind
// (text, compressed), lacks a property, or holds numbers that no splat has. Nothing is allocated
// for more splats than the file has bytes for, and it has at most 1 GiB.
Splats ReadSplats(const std::string& path);

// Writes the file whole, or throws Error.
void WriteSplats(const Splats& splats, const std::string& path);

}  // namespace physpring

#endif  // PHYSPRING_SPLATS_SPLAT_FILE_H_
