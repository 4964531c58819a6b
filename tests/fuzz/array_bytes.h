// SPDX-License-Identifier: Apache-2.0
// Named arrays as bytes that can be mutated: an .npz archive has checksums, which almost every
// mutation breaks. A record is
//   length of the name (1 byte), name, type (1), dimensions (1), extents (2 bytes each, low first),
//   values (as many bytes as type and extents say, at most to the end; zeros are added)
#ifndef PHYSPRING_TESTS_FUZZ_ARRAY_BYTES_H_
#define PHYSPRING_TESTS_FUZZ_ARRAY_BYTES_H_

#include <string>
#include <string_view>

#include "twin/npz.h"

namespace physpring {

// Arrays as ParseNpz might have read them. An extent of 65535 stands for 2^31 - 1. A record of more
// than 4096 values is left out, and so is one whose name was there before.
Npz ArraysOf(std::string_view bytes);

// Bytes of which ArraysOf makes these arrays.
std::string BytesOf(const Npz& arrays);

}  // namespace physpring

#endif  // PHYSPRING_TESTS_FUZZ_ARRAY_BYTES_H_
