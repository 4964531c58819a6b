// SPDX-License-Identifier: Apache-2.0
// The header of a .ply file of splats: where in the file each number of a splat is.
#ifndef PHYSPRING_SPLATS_PLY_HEADER_H_
#define PHYSPRING_SPLATS_PLY_HEADER_H_

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace physpring {

constexpr int kMostSplats = 4000000;

// What it says of the element `vertex`, which comes first.
struct PlyHeader {
  std::int64_t count = 0;
  std::size_t start = 0;                      // of the first row, bytes from the file's beginning
  std::size_t stride = 0;                     // bytes of a row
  std::map<std::string, std::size_t> floats;  // where each property of floats is in a row
};

// Of the file `path`, which holds `bytes`. Throws Error, one line that begins with the path, unless
// it is binary, little endian, not compressed, and has 1 to kMostSplats rows.
PlyHeader ReadPlyHeader(const std::string& path, std::string_view bytes);

// Where the property is in a row. Throws Error if there is none of floats.
std::size_t FloatAt(const PlyHeader& header, const std::string& path, const std::string& name);

// Throws Error: "PATH: WHAT".
[[noreturn]] void FailPly(const std::string& path, const std::string& what);

}  // namespace physpring

#endif  // PHYSPRING_SPLATS_PLY_HEADER_H_
