// SPDX-License-Identifier: Apache-2.0
// What a fuzz target is: a source that hands any bytes to one parser, and knows a few sound inputs.
// libFuzzer calls LLVMFuzzerTestOneInput; seeded_run.cc does so in every build.
#ifndef PHYSPRING_TESTS_FUZZ_FUZZ_TARGET_H_
#define PHYSPRING_TESTS_FUZZ_FUZZ_TARGET_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace physpring {

// Sound inputs of the target, from which mutations begin.
std::vector<std::string> FuzzSeeds();

inline std::string_view TextOf(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

// Runs `parse`, which may refuse with Error, or with PolicyError: one line of at most 1500
// characters, that begins with `start`. Aborts where the message is another; what else is thrown
// ends the program.
void MayRefuse(std::string_view start, const std::function<void()>& parse);

// A folder of this process in memory, for parsers that read files. Removed at the end.
const std::string& FuzzFolder();

// Writes a file there without care: nothing is synced.
void WriteFuzzFile(const std::string& path, std::string_view bytes);

}  // namespace physpring

#endif  // PHYSPRING_TESTS_FUZZ_FUZZ_TARGET_H_
