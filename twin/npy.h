// SPDX-License-Identifier: Apache-2.0
// The header of a .npy array: magic, version, and a Python dictionary that says type, order and
// shape. Versions 1 to 3; little endian and C order only.
#ifndef PHYSPRING_TWIN_NPY_H_
#define PHYSPRING_TWIN_NPY_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace physpring {

// Bytes of a value of a numpy type such as "<f4"; 0 for types that are not read.
std::size_t BytesOfType(std::string_view type);

// Number of values in an array of this shape; nothing where that overflows.
std::optional<std::size_t> CountOfShape(const std::vector<std::size_t>& shape);

// As numpy prints it: "()", "(4,)", "(120, 76, 3)".
std::string FormatShape(const std::vector<std::size_t>& shape);

struct NpyHeader {
  std::string type;
  std::vector<std::size_t> shape;
};

// Length in bytes of preamble and header, from the first `kNpyPreamble` bytes of an array (fewer in
// version 1 are enough). Throws Error (without a path) when they are no preamble.
constexpr std::size_t kNpyPreamble = 12;
std::size_t NpyHeaderLength(std::string_view preamble);

// Reads preamble and header. Throws Error (without a path) when it is malformed, or describes what
// is not read: unknown types, big endian, Fortran order with more than one dimension, more than 32
// dimensions, an extent of 2^31 or more.
NpyHeader ParseNpyHeader(std::string_view bytes);

// Preamble and header, version 1, padded so that the values start at a multiple of 64 bytes.
std::string FormatNpyHeader(const NpyHeader& header);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_NPY_H_
