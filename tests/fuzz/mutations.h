// SPDX-License-Identifier: Apache-2.0
// Small damages to bytes, the same ones on every machine.
#ifndef PHYSPRING_TESTS_FUZZ_MUTATIONS_H_
#define PHYSPRING_TESTS_FUZZ_MUTATIONS_H_

#include <random>
#include <string>

namespace physpring {

// Changes `bytes` in one to four places: bits, bytes, pieces that are cut, doubled or moved, and
// numbers that are easily forgotten, binary or as text.
void MutateBytes(std::mt19937& random, std::string* bytes);

}  // namespace physpring

#endif  // PHYSPRING_TESTS_FUZZ_MUTATIONS_H_
